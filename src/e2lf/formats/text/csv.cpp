// SPDX-License-Identifier: MIT
// Reads and writes text tables; declared in codecs.h.
#include <algorithm>
#include <charconv>
#include <cstring>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/table/table.h"
#include "e2lf/formats/text/csv_layout.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"
#include "e2lf/recordings/side_triggers.h"

namespace e2lf::formats::text {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kHeadBytes = size_t{1} << 14;  // from which the columns are determined
constexpr size_t kLongestHead = size_t{1} << 20;
constexpr size_t kLongestLine = 4096;
constexpr size_t kShortestLine = 8;  // "0,0,0,0\n"

/// Lines that are not events.
struct BadLines {
  size_t count = 0;
  size_t first_byte = 0;   ///< offset of the first one in the text
  std::string first = {};  ///< content of the first one

  /// Adds the bad lines of a text that begins at offset `byte` of this one.
  void append(const BadLines& later, size_t byte) {
    if (count == 0 && later.count > 0) {
      first_byte = byte + later.first_byte;
      first = later.first;
    }
    count += later.count;
  }
};

bool is_remark(std::string_view line, const TextLayout& layout) {
  return line.find_first_not_of(" \t\r\n,;") == std::string_view::npos || is_comment(line) ||
         line == layout.header_line;
}

/// Parses a line that is not simply an event, which may follow a byte order mark.
void parse_odd_line(std::string_view line, size_t byte, const TextLayout& layout, EventColumns& events, BadLines& bad) {
  line = without_mark(line);
  Event event;
  if (line.size() <= kLongestLine && parse_line(line, layout, event)) {
    events.push_back(event);
  } else if (!is_remark(line, layout) && bad.count++ == 0) {
    bad.first_byte = byte;
    bad.first = quoted(line);
  }
}

/// Appends the events of complete lines, and returns the lines that are not events.
BadLines parse_lines(std::string_view text, const TextLayout& layout, EventColumns& events) {
  BadLines bad;
  Event event;
  for (size_t begin = 0; begin < text.size();) {
    const void* const found = std::memchr(text.data() + begin, '\n', text.size() - begin);
    const size_t end =
        found == nullptr ? text.size() : static_cast<size_t>(static_cast<const char*>(found) - text.data());
    const std::string_view line = text.substr(begin, end - begin);
    if (line.size() <= kLongestLine && parse_line(line, layout, event)) {
      events.push_back(event);
    } else {
      parse_odd_line(line, begin, layout, events, bad);
    }
    begin = end + 1;
  }
  return bad;
}

class CsvBlocks final : public EventBlocks {
 public:
  CsvBlocks(SourcePtr source, TextLayout layout, RecordingInfo info, int threads)
      : source_(std::move(source)),
        layout_(std::move(layout)),
        info_(std::move(info)),
        threads_(threads == 0 ? num_threads() : threads) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    E2LF_ASSIGN_OR_RETURN(const std::string_view text, fetch_lines());
    if (text.empty()) {
      E2LF_RETURN_IF_ERROR(table::require_mostly_events(events_, bad_, info_, first_bad_, source_->name()));
      return false;
    }
    const BadLines bad = threads_ == 1 ? parse_lines(text, layout_, block.events) : parse_parallel(text, block.events);
    const uint64_t first_byte = source_->position() + bad.first_byte;
    summary.add_dropped(Violation::kBadRecord, first_byte, bad.count);
    if (bad_ == 0 && bad.count > 0) first_bad_ = cat(" (the first at byte ", first_byte, ": ", bad.first, ")");
    events_ += block.events.size();
    bad_ += bad.count;
    is_within_line_ = text.back() != '\n';
    source_->consume(text.size());
    return true;
  }

  Result<void> seek_before(int64_t) override {
    is_within_line_ = false;
    events_ = bad_ = 0;
    return source_->seek(layout_.header_bytes);
  }

 private:
  /// Returns the complete lines that are available; empty at the end.
  Result<std::string_view> fetch_lines() {
    const size_t block = kBlockBytes * static_cast<size_t>(threads_);
    if (is_within_line_) E2LF_RETURN_IF_ERROR(skip_line());
    size_t wanted = source_->seekable() ? block : 1;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(wanted));
      const std::string_view text = as_text(bytes).substr(0, block);
      const size_t newline = text.rfind('\n');
      if (newline != std::string_view::npos) return text.substr(0, newline + 1);
      // A number that is cut off by a stop request has another value.
      if (bytes.size() < wanted && stop_requested() && !source_->seekable()) return std::string_view();
      // The last line may lack its line ending; a line that is too long is returned and counted as bad once.
      if (bytes.size() < wanted || text.size() > kLongestLine) return text;
      wanted = text.size() + 1;
    }
  }

  /// Skips the rest of a line whose beginning was returned.
  Result<void> skip_line() {
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(1));
      const auto newline = std::find(bytes.begin(), bytes.end(), uint8_t{'\n'});
      const bool is_found = newline != bytes.end();
      source_->consume(static_cast<size_t>(newline - bytes.begin()) + (is_found ? 1 : 0));
      if (is_found || bytes.empty()) return {};
    }
  }

  BadLines parse_parallel(std::string_view text, EventColumns& events) {
    const auto parts = static_cast<size_t>(threads_);
    std::vector<size_t> begins = {0};
    for (size_t i = 1; i < parts; ++i) {
      const size_t newline = text.find('\n', std::max(begins.back(), text.size() * i / parts));
      begins.push_back(newline == std::string_view::npos ? text.size() : newline + 1);
    }
    begins.push_back(text.size());
    parts_.resize(parts);
    std::vector<BadLines> bad(parts);
    parallel_for(parts, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) {
        parts_[i].clear();
        parts_[i].reserve((begins[i + 1] - begins[i]) / kShortestLine);
        bad[i] = parse_lines(text.substr(begins[i], begins[i + 1] - begins[i]), layout_, parts_[i]);
      }
    });
    BadLines all_bad;
    for (size_t i = 0; i < parts; ++i) {
      events.append(parts_[i]);
      all_bad.append(bad[i], begins[i]);
    }
    return all_bad;
  }

  SourcePtr source_;
  TextLayout layout_;
  RecordingInfo info_;
  int threads_;
  uint64_t events_ = 0, bad_ = 0;
  std::string first_bad_;
  bool is_within_line_ = false;  ///< whether the current line is too long and was counted
  std::vector<EventColumns> parts_;
};

/// Parses the first lines, or more if the header is longer.
Result<TextHead> fetch_head(ByteSource& source, const std::string& name) {
  for (size_t wanted = kHeadBytes;; wanted *= 4) {
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source.fetch(wanted));
    const bool is_whole = bytes.size() < wanted;
    E2LF_ASSIGN_OR_RETURN(TextHead head, read_head(bytes.first(std::min(bytes.size(), wanted)), is_whole, name));
    if (head.lines > 0 || !head.first_bad.empty() || is_whole || wanted >= kLongestHead) return head;
  }
}

/// Fails if most of the first lines are not rows of numbers.
Result<void> check_head(const TextHead& head, const std::string& name) {
  const bool has_rows = !head.sample.columns.empty();
  if (head.first_bad.empty() || (has_rows && 2 * head.bad_lines <= head.lines)) return {};
  return fail(ErrorCode::kFormat, cat(name, ": line ", head.first_bad_number), head.first_bad,
              has_rows ? cat(" and ", head.bad_lines - 1, " of the first ", head.lines, " lines are no") : " is no",
              " event, that is, a line with the numbers t, x, y and p; is this a recording?");
}

/// Determines the layout, and leaves the source at the first event.
Result<TextLayout> decide(ByteSource& source, const OpenOptions& options, const TextHead& head, RecordingInfo& info) {
  source.consume(head.header_bytes);
  TextLayout layout;
  layout.header_bytes = head.header_bytes;
  layout.header_line = head.header_line;
  if (head.sample.columns.empty()) {
    layout.columns = {table::Field::kX, table::Field::kY, table::Field::kP, table::Field::kT};
    return layout;
  }
  E2LF_ASSIGN_OR_RETURN(const table::TableLayout decided, decide_layout(head.sample, options, source.name(), info));
  layout.columns.resize(head.sample.columns.size());
  for (size_t field = 0; field < table::kNumFields; ++field) {
    layout.columns[decided.columns[field]] = static_cast<table::Field>(field);
  }
  layout.unit = decided.unit;
  layout.polarity = decided.polarity;
  return layout;
}

/// Opens a text. If the format was given, it defines the order of columns without names.
Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options, const char* format, const char* order) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(TextHead head, fetch_head(*source, name));
  E2LF_RETURN_IF_ERROR(check_head(head, name));
  if (!options.format.empty()) head.sample.order = order;
  RecordingInfo info;
  if (options.width == 0 || options.height == 0) {
    info.width = head.width;
    info.height = head.height;
  }
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  E2LF_ASSIGN_OR_RETURN(TextLayout layout, decide(*source, options, head, info));
  const bool is_seconds = layout.unit == TimeUnit::kSeconds;
  info.format = !options.format.empty() || !info.table ? format : is_seconds ? "txt" : "csv";
  E2LF_ASSIGN_OR_RETURN(BlocksPtr triggers, open_side_triggers(source->path()));
  auto lines = std::make_unique<CsvBlocks>(std::move(source), std::move(layout), info, options.threads);
  return std::make_unique<RecordingReader>(std::move(lines), std::move(info), name, options, std::move(triggers));
}

/// Size of two coordinates, a polarity and a time with separators.
constexpr size_t kLongestWrittenLine = 5 + 5 + 1 + 21 + 4;
constexpr size_t kMinEventsPerThread = 4096;

/// Writes events [begin, end) as lines and returns the end of the text; `out` has kLongestWrittenLine bytes for each.
char* format_lines(const EventColumns& events, size_t begin, size_t end, char* out) {
  const auto put = [&out](auto number, char separator) {
    out = std::to_chars(out, out + kLongestWrittenLine, number).ptr;
    *out++ = separator;
  };
  for (size_t i = begin; i < end; ++i) {
    put(events.x[i], ',');
    put(events.y[i], ',');
    put(events.p[i], ',');
    put(events.t[i], '\n');
  }
  return out;
}

class CsvWriter final : public RecordingWriter {
 public:
  CsvWriter(SinkPtr sink, const RecordingInfo& info)
      : sink_(std::move(sink)), check_(info.width, info.height, sink_->name()) {}

  bool holds_triggers() const override { return false; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    format(batch.events);
    for (const auto& piece : pieces_) E2LF_RETURN_IF_ERROR(sink_->write(piece));
    return {};
  }

  Result<void> finish() override { return sink_->commit(); }

 private:
  /// Sets pieces_; each part of the batch is formatted into its own part of the buffer.
  void format(const EventColumns& events) {
    const size_t count = events.size();
    const size_t parts = std::clamp<size_t>(count / kMinEventsPerThread, 1, 4 * static_cast<size_t>(num_threads()));
    if (buffer_.size() < count * kLongestWrittenLine) buffer_.resize(count * kLongestWrittenLine);
    pieces_.resize(parts);
    const auto begin_of = [&](size_t part) { return count * part / parts; };
    parallel_for(parts, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) {
        char* const begin = buffer_.data() + begin_of(i) * kLongestWrittenLine;
        const char* const end = format_lines(events, begin_of(i), begin_of(i + 1), begin);
        pieces_[i] = {reinterpret_cast<const uint8_t*>(begin), static_cast<size_t>(end - begin)};
      }
    });
  }

  SinkPtr sink_;
  BatchCheck check_;
  Column<char> buffer_;
  std::vector<std::span<const uint8_t>> pieces_;  ///< the lines of a batch, in parts of the buffer
};

}  // namespace

bool detect(std::span<const uint8_t> head) {
  // An archive may contain a text without compression.
  if (std::find(head.begin(), head.end(), uint8_t{0}) != head.end()) return false;
  // A list of lists in JSON is a line of many numbers.
  const std::string_view begin = as_text(head).substr(0, 2);
  if (begin == "[[" || begin == "[{") return false;
  const auto read = read_head(head.first(std::min(head.size(), kDetectBytes)), head.size() < kDetectBytes, "");
  return read.ok() && !read->sample.columns.empty() && 2 * read->bad_lines <= read->lines;
}

Result<ReaderPtr> open_csv(SourcePtr source, const OpenOptions& options) {
  return open(std::move(source), options, "csv", "xypt");
}

Result<ReaderPtr> open_txt(SourcePtr source, const OpenOptions& options) {
  return open(std::move(source), options, "txt", "txyp");
}

Result<WriterPtr> create_csv(SinkPtr sink, const RecordingInfo& info) {
  const bool has_size = info.width != 0 && info.height != 0;
  const std::string header = has_size ? cat("%geometry:", info.width, ',', info.height, '\n') : "%x,y,p,t\n";
  E2LF_RETURN_IF_ERROR(sink->write(as_bytes(header)));
  return WriterPtr(std::make_unique<CsvWriter>(std::move(sink), info));
}

}  // namespace e2lf::formats::text
