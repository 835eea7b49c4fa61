// SPDX-License-Identifier: MIT
#include "e2lf/recordings/side_triggers.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kMostTriggerBytes = size_t{1} << 30;
constexpr std::string_view kTriggerBlanks = " \t\r\"";  // and quotation marks

std::optional<Trigger> parse_line(std::string_view line) {
  int64_t values[3] = {};
  for (int i = 0; i < 3; ++i) {
    const size_t comma = i < 2 ? std::min(line.find(','), line.size()) : line.size();
    const auto value = parse_number<int64_t>(trimmed(line.substr(0, comma), kTriggerBlanks));
    if (!value) return std::nullopt;
    values[i] = *value;
    line.remove_prefix(std::min(line.size(), comma + 1));
  }
  if (values[1] < 0 || values[1] > UINT16_MAX) return std::nullopt;
  return Trigger{values[2], static_cast<uint16_t>(values[1]), static_cast<uint8_t>(values[0] > 0)};
}

bool is_trigger_header(std::string_view line) {
  std::string names(without_mark(line));
  std::erase_if(names, [](char c) { return kTriggerBlanks.find(c) != std::string_view::npos; });
  return lower_case(names) == "p,id,t";
}

class SideTriggerFile final : public EventBlocks {
 public:
  explicit SideTriggerFile(SourcePtr source) : source_(std::move(source)) {}

  /// Returns all triggers at once, sorted.
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    E2LF_ASSIGN_OR_RETURN(const auto bytes, read_rest(*source_, kMostTriggerBytes));
    const std::string_view text = as_text(bytes);
    uint64_t lost = 0;
    for (size_t at = 0; at < text.size();) {
      const std::string_view line = text.substr(at, text.find('\n', at) - at);
      if (const auto trigger = parse_line(line)) {
        block.triggers.push_back(*trigger);
      } else if (!is_trigger_header(line) && !trimmed(line, kTriggerBlanks).empty()) {
        summary.add_dropped(Violation::kBadRecord, at);
        ++lost;
      }
      at += line.size() + 1;
    }
    if (lost > 0) {
      log_warning(cat(source_->name(), ": ", lost, " lines are not triggers (p,id,t with t in whole microseconds)"));
    }
    std::ranges::stable_sort(block.triggers, {}, &Trigger::t);
    return false;
  }

  Result<void> seek_before(int64_t) override { return source_->seek(0); }

 private:
  SourcePtr source_;
};

}  // namespace

std::filesystem::path side_trigger_path(const std::filesystem::path& recording) {
  return recording.parent_path() / (recording.stem().string() + "_triggers.csv");
}

Result<BlocksPtr> open_side_triggers(const std::filesystem::path& recording) {
  if (recording.empty()) return BlocksPtr();
  const std::filesystem::path path = path_beside(recording, side_trigger_path);
  if (!is_present(path)) return BlocksPtr();
  E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(path));
  E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
  const std::string_view first = as_text(head).substr(0, as_text(head).substr(0, kDetectBytes).find('\n'));
  if (!is_trigger_header(first)) {
    return fail(ErrorCode::kFormat, source->name(), "this file would contain the triggers of ",
                recording.filename().string(),
                ", but does not begin with the names p,id,t; write p,id,t in this order, with t in whole "
                "microseconds, or give the file another name");
  }
  return make_side_triggers(std::move(source));
}

BlocksPtr make_side_triggers(SourcePtr source) {
  return std::make_unique<SideTriggerFile>(std::move(source));
}

}  // namespace e2lf::recordings
