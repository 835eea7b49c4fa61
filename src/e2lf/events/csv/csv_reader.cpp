// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/events/batch_check.h"
#include "e2lf/events/csv/csv.h"
#include "e2lf/events/csv/csv_layout.h"
#include "e2lf/events/event_blocks.h"
#include "e2lf/events/registry.h"
#include "e2lf/events/side_triggers.h"

namespace e2lf::events::csv {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kLongestLine = 4096;
constexpr size_t kShortestLine = 8;  // "0,0,0,0\n"

/// Appends the events of whole lines; returns how many lines are not events.
size_t parse_lines(std::string_view text, const Layout& layout, EventColumns& events) {
  size_t bad = 0;
  Event event;
  for (size_t begin = 0; begin < text.size();) {
    const void* const found = std::memchr(text.data() + begin, '\n', text.size() - begin);
    const size_t end =
        found == nullptr ? text.size() : static_cast<size_t>(static_cast<const char*>(found) - text.data());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (parse_line(line, layout, event)) {
      events.push_back(event);
    } else {
      bad += !line.empty() && line != "\r" && line[0] != '#' && line[0] != '%';
    }
  }
  return bad;
}

class CsvBlocks final : public EventBlocks {
 public:
  CsvBlocks(std::unique_ptr<ByteSource> source, const Layout& layout, int threads)
      : source_(std::move(source)), layout_(layout), threads_(threads == 0 ? num_threads() : threads) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    E2LF_ASSIGN_OR_RETURN(const std::string_view text, fetch_lines());
    if (text.empty()) return false;
    const size_t bad = threads_ == 1 ? parse_lines(text, layout_, block.events) : parse_parallel(text, block.events);
    if (bad > 0) summary.add(Violation::kBadRecord, source_->position(), bad);
    summary.dropped_words += bad;
    source_->consume(text.size());
    return true;
  }

  Result<void> seek_before(int64_t) override { return source_->seek(layout_.header_bytes); }

 private:
  /// Whole lines, as many as are at hand; empty at the end.
  Result<std::string_view> fetch_lines() {
    const size_t block = kBlockBytes * static_cast<size_t>(threads_);
    size_t wanted = source_->seekable() ? block : 1;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(wanted));
      const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), block));
      const size_t newline = text.rfind('\n');
      if (newline != std::string_view::npos) return text.substr(0, newline + 1);
      // The last line may lack its end; one that never ends is handed on to be counted as bad.
      if (bytes.size() < wanted || text.size() >= kLongestLine) return text;
      wanted = text.size() + 1;
    }
  }

  size_t parse_parallel(std::string_view text, EventColumns& events) {
    const auto parts = static_cast<size_t>(threads_);
    std::vector<size_t> begins = {0};
    for (size_t i = 1; i < parts; ++i) {
      const size_t newline = text.find('\n', std::max(begins.back(), text.size() * i / parts));
      begins.push_back(newline == std::string_view::npos ? text.size() : newline + 1);
    }
    begins.push_back(text.size());
    parts_.resize(parts);
    std::vector<size_t> bad(parts);
    parallel_for(parts, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) {
        parts_[i].clear();
        parts_[i].reserve((begins[i + 1] - begins[i]) / kShortestLine);
        bad[i] = parse_lines(text.substr(begins[i], begins[i + 1] - begins[i]), layout_, parts_[i]);
      }
    });
    size_t all_bad = 0;
    for (size_t i = 0; i < parts; ++i) {
      events.append(parts_[i]);
      all_bad += bad[i];
    }
    return all_bad;
  }

  std::unique_ptr<ByteSource> source_;
  Layout layout_;
  int threads_;
  std::vector<EventColumns> parts_;
};

Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source, const OpenOptions& options,
                                              const char* format, const Layout& fallback) {
  RecordingInfo info;
  info.format = format;
  E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
  const Layout layout = find_layout(head.first(std::min(head.size(), kDetectBytes))).value_or(fallback);
  source->consume(layout.header_bytes);
  info.width = layout.width;
  info.height = layout.height;
  const std::string name = source->name();
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  E2LF_ASSIGN_OR_RETURN(TriggerFeed triggers, open_side_triggers(source->path()));
  return make_block_reader(std::make_unique<CsvBlocks>(std::move(source), layout, options.threads), std::move(info),
                           name, options, std::move(triggers));
}

}  // namespace

bool detect_csv(std::span<const uint8_t> head) {
  const auto layout = find_layout(head);
  return layout && !layout->is_seconds;
}

bool detect_txt(std::span<const uint8_t> head) {
  const auto layout = find_layout(head);
  return layout && layout->is_seconds;
}

Result<std::unique_ptr<RecordingReader>> open_csv(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  return open(std::move(source), options, "csv", Layout());
}

Result<std::unique_ptr<RecordingReader>> open_txt(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  Layout fallback;
  fallback.order = kTxtOrder;
  fallback.is_seconds = true;
  return open(std::move(source), options, "txt", fallback);
}

}  // namespace e2lf::events::csv
