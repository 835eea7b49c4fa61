// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/text/csv_layout.h"
#include "e2lf/recordings/codecs/text/text.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/side_triggers.h"
#include "e2lf/recordings/time_search.h"
#include "e2lf/recordings/time_sort.h"

namespace e2lf::recordings::text {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kLongestLine = 4096;
constexpr size_t kSeekBytes = 16384;  // between the places that a seek looks at; more than some lines
constexpr size_t kShortestLine = 8;   // "0,0,0,0\n"

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
    if (line.size() <= kLongestLine && parse_line(line, layout, event)) {
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
    is_within_line_ = text.back() != '\n';
    source_->consume(text.size());
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    is_within_line_ = false;
    E2LF_RETURN_IF_ERROR(source_->seek(layout_.header_bytes));
    const uint64_t bytes = source_->size().value_or(0);
    const uint64_t places = bytes < layout_.header_bytes ? 0 : (bytes - layout_.header_bytes) / kSeekBytes;
    const auto place_of = [&](uint64_t i) { return layout_.header_bytes + i * kSeekBytes; };
    const auto time_at = [&](uint64_t i) { return time_behind(place_of(i)); };
    E2LF_ASSIGN_OR_RETURN(const uint64_t place, find_place_before(places, t_us, time_at));
    if (place == 0) return source_->seek(layout_.header_bytes);
    E2LF_ASSIGN_OR_RETURN(const uint64_t line, line_behind(place_of(place)));
    return source_->seek(line);
  }

 private:
  /// Where the first line begins that begins at or behind a byte.
  Result<uint64_t> line_behind(uint64_t byte) {
    E2LF_RETURN_IF_ERROR(source_->seek(byte - 1));
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kLongestLine));
    const auto newline = std::find(bytes.begin(), bytes.end(), uint8_t{'\n'});
    return byte - 1 + static_cast<uint64_t>(newline - bytes.begin()) + (newline == bytes.end() ? 0 : 1);
  }

  /// The time of the lines there; where none can be read, later than any.
  Result<int64_t> time_behind(uint64_t byte) {
    E2LF_ASSIGN_OR_RETURN(const uint64_t line, line_behind(byte));
    E2LF_RETURN_IF_ERROR(source_->seek(line));
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kLongestLine));
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kLongestLine));
    text = text.substr(0, text.rfind('\n') + 1);
    EventColumns events;
    parse_lines(text, layout_, events);
    if (events.empty()) return INT64_MAX;
    const size_t count = std::min(kTimesPerProbe, events.size());
    return median_time({events.t.begin(), events.t.begin() + static_cast<ptrdiff_t>(count)});
  }

  /// Whole lines, as many as are at hand; empty at the end.
  Result<std::string_view> fetch_lines() {
    const size_t block = kBlockBytes * static_cast<size_t>(threads_);
    if (is_within_line_) E2LF_RETURN_IF_ERROR(skip_line());
    size_t wanted = source_->seekable() ? block : 1;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(wanted));
      const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), block));
      const size_t newline = text.rfind('\n');
      if (newline != std::string_view::npos) return text.substr(0, newline + 1);
      // A number that a stop cut is another number.
      if (bytes.size() < wanted && stop_requested() && !source_->seekable()) return std::string_view();
      // The last line may lack its end; one that never ends is handed on to be counted as bad, once.
      if (bytes.size() < wanted || text.size() > kLongestLine) return text;
      wanted = text.size() + 1;
    }
  }

  /// Passes over the rest of a line whose beginning was handed on.
  Result<void> skip_line() {
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(1));
      const auto newline = std::find(bytes.begin(), bytes.end(), uint8_t{'\n'});
      const bool is_found = newline != bytes.end();
      source_->consume(static_cast<size_t>(newline - bytes.begin()) + (is_found ? 1 : 0));
      if (is_found || bytes.empty()) return {};
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
  bool is_within_line_ = false;  ///< the line at hand is too long and was counted
  std::vector<EventColumns> parts_;
};

/// The first line that is neither empty nor a comment; empty when there is none.
std::string_view first_data_line(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    if (!line.empty() && line[0] != '#' && line[0] != '%') return line;
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return {};
}

/// The layout that the first lines show; `fallback` where they hold no event, or one of that layout behind damage.
Result<Layout> layout_of(std::span<const uint8_t> head, const Layout& fallback, const std::string& name) {
  if (const auto layout = find_layout(head)) return *layout;
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  const std::string_view line = first_data_line(text);
  EventColumns events;
  parse_lines(text, fallback, events);
  if (line.empty() || !events.empty()) return fallback;
  constexpr size_t kQuoted = 60;
  return Error{ErrorCode::kFormat,
               cat("the columns of \"", line.substr(0, kQuoted), line.size() > kQuoted ? "..." : "",
                   "\" are not known; events are lines x,y,p,t (t in us) or t x y p (t in s), or a first line names "
                   "the four columns, as t,x,y,p"),
               name};
}

Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source, const OpenOptions& options,
                                              const char* format, const Layout& fallback) {
  RecordingInfo info;
  info.format = format;
  E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const Layout layout,
                        layout_of(head.first(std::min(head.size(), kDetectBytes)), fallback, name));
  source->consume(layout.header_bytes);
  info.width = layout.width;
  info.height = layout.height;
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  E2LF_ASSIGN_OR_RETURN(TriggerFeed triggers, open_side_triggers(source->logical_path()));
  const bool is_seekable = source->seekable();
  auto lines = std::make_unique<CsvBlocks>(std::move(source), layout, options.threads);
  return make_block_reader(make_time_sorted(std::move(lines), is_seekable, name), std::move(info), name, options,
                           std::move(triggers));
}

}  // namespace

bool detect_csv(std::span<const uint8_t> head) {
  const auto layout = find_layout(head);
  return layout && layout->has_events && !layout->is_seconds;
}

bool detect_txt(std::span<const uint8_t> head) {
  const auto layout = find_layout(head);
  return layout && layout->has_events && layout->is_seconds;
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

}  // namespace e2lf::recordings::text
