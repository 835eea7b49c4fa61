// SPDX-License-Identifier: MIT
#include "e2lf/recordings/side_triggers.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/io/decompress.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kLongestTriggerLine = 256;

constexpr std::string_view kBlanks = " \t\r\"";  // and quotation marks

std::optional<Trigger> parse_line(std::string_view line) {
  int64_t values[3] = {};
  for (int i = 0; i < 3; ++i) {
    const size_t comma = i < 2 ? std::min(line.find(','), line.size()) : line.size();
    const std::string_view word = trimmed(line.substr(0, comma), kBlanks);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), values[i]);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    line.remove_prefix(std::min(line.size(), comma + 1));
  }
  if (values[1] < 0 || values[1] > UINT16_MAX) return std::nullopt;
  return Trigger{values[2], static_cast<uint16_t>(values[1]), static_cast<uint8_t>(values[0] > 0)};
}

/// Returns whether a line contains the names p, id and t, and nothing else.
bool is_usual_header(std::string_view line) {
  std::string names;
  for (const char c : line) {
    if (kBlanks.find(c) == std::string_view::npos) names += c;
  }
  return lower_case(names) == "p,id,t";
}

/// Returns whether a line contains names of columns.
bool is_header(std::string_view line) {
  line = trimmed(without_mark(line), kBlanks);
  return !line.empty() && std::isalpha(static_cast<unsigned char>(line[0])) != 0;
}

/// Returns whether a line is empty, a comment, or the column names in front of the triggers.
bool is_remark(std::string_view line) {
  line = trimmed(without_mark(line), kBlanks);
  return line.empty() || line[0] == '#' || line[0] == '%' || is_usual_header(line);
}

/// Returns the first line that is neither a comment nor the usual names of the columns.
Result<std::string> first_line(ByteSource& source) {
  E2LF_ASSIGN_OR_RETURN(const auto head, source.fetch(kDetectBytes));
  std::string_view text = as_text(head).substr(0, kDetectBytes);
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with("%geometry") || !is_remark(line)) return std::string(line);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return std::string();
}

class SideTriggerFile final : public TriggerSource {
 public:
  explicit SideTriggerFile(SourcePtr source) : source_(std::move(source)) {}

  /// Returns all triggers at once, sorted.
  Result<bool> next(std::vector<Trigger>& block, DecodeSummary& summary) override {
    const auto begin = static_cast<ptrdiff_t>(block.size());
    const uint64_t bad = summary.of(Violation::kBadRecord).count;
    for (bool more = true; more;) {
      E2LF_ASSIGN_OR_RETURN(more, read_lines(block, summary));
    }
    if (const uint64_t lost = summary.of(Violation::kBadRecord).count - bad; lost > 0) {
      log_warning(cat(source_->name(), ": ", lost, " lines are not triggers (p,id,t with t in whole microseconds)"));
    }
    std::stable_sort(block.begin() + begin, block.end(), [](const Trigger& a, const Trigger& b) { return a.t < b.t; });
    return false;
  }

  Result<void> rewind() override {
    is_within_line_ = false;
    return source_->seek(0);
  }

 private:
  /// Appends the triggers of the available lines; returns false at the end.
  Result<bool> read_lines(std::vector<Trigger>& block, DecodeSummary& summary) {
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kLongestTriggerLine));
    if (bytes.empty()) return false;
    const std::string_view text = as_text(bytes);
    size_t used = 0;
    for (size_t end = 0; (end = text.find('\n', used)) != std::string_view::npos; used = end + 1) {
      add_line(text.substr(used, end - used), source_->position() + used, block, summary);
      is_within_line_ = false;
    }
    // The remainder is the last line of the file or of the available bytes, or a line that is too long to be valid.
    if (used == 0) {
      add_line(text, source_->position(), block, summary);
      is_within_line_ = true;
      used = text.size();
    }
    source_->consume(used);
    return true;
  }

  /// A line that is too long is invalid, wherever the available bytes end.
  void add_line(std::string_view line, uint64_t byte, std::vector<Trigger>& block, DecodeSummary& summary) const {
    if (is_within_line_ || is_remark(line)) return;
    const auto trigger = line.size() < kLongestTriggerLine ? parse_line(line) : std::nullopt;
    if (trigger) {
      block.push_back(*trigger);
    } else {
      summary.add_dropped(Violation::kBadRecord, byte);
    }
  }

  SourcePtr source_;
  bool is_within_line_ = false;  ///< whether the beginning of the current line was too long
};

}  // namespace

std::filesystem::path side_trigger_path(const std::filesystem::path& recording) {
  return recording.parent_path() / (recording.stem().string() + "_triggers.csv");
}

Result<TriggersPtr> open_side_triggers(const std::filesystem::path& recording) {
  if (recording.empty()) return TriggersPtr();
  E2LF_ASSIGN_OR_RETURN(auto source, open_file_beside(side_trigger_path(recording)));
  if (source == nullptr) return TriggersPtr();
  E2LF_ASSIGN_OR_RETURN(const std::string first, first_line(*source));
  // An independent recording with such a name.
  const bool is_recording = first.starts_with("%geometry") || std::count(first.begin(), first.end(), ',') == 3;
  if (is_recording) {
    log_warning(cat(side_trigger_path(recording).string(), ": this file contains events and not the triggers of ",
                    recording.filename().string(), ", so it is left out; give one of them another name"));
    return TriggersPtr();
  }
  if (is_header(first)) {
    return Error{ErrorCode::kFormat,
                 cat("the columns of triggers are ", printable(trimmed(first, kBlanks)),
                     "; write p,id,t in this order, with t in whole microseconds"),
                 source->name()};
  }
  return make_side_triggers(std::move(source));
}

TriggersPtr make_side_triggers(SourcePtr source) {
  return std::make_unique<SideTriggerFile>(std::move(source));
}

Result<void> SideTriggerWriter::write(std::span<const Trigger> triggers) {
  if (triggers.empty()) return {};
  std::string text;
  if (sink_ == nullptr) {
    E2LF_ASSIGN_OR_RETURN(sink_, open_file_sink(path_));
    text = "p,id,t\n";
  }
  for (const Trigger& trigger : triggers) text += cat(int{trigger.p}, ',', trigger.id, ',', trigger.t, '\n');
  return sink_->write(as_bytes(text));
}

Result<void> SideTriggerWriter::finish() {
  return sink_ == nullptr ? Result<void>{} : sink_->commit();
}

}  // namespace e2lf::recordings
