// SPDX-License-Identifier: MIT
// Writes text tables; declared in codecs.h.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <future>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::formats::text {
namespace {

/// Size of two coordinates, a polarity and a time with separators, and room for stores of four bytes at the end.
constexpr size_t kLongestWrittenLine = 5 + 5 + 1 + 21 + 4 + 8;
constexpr size_t kMinEventsPerThread = 4096;

/// The numbers 0..9999 with four digits each.
struct DigitTable {
  std::array<char, 4 * 10000 + 4> digits{};

  DigitTable() {
    for (int i = 0; i < 10000; ++i) {
      const int parts[4] = {i / 1000, i / 100 % 10, i / 10 % 10, i % 10};
      for (int j = 0; j < 4; ++j) digits[static_cast<size_t>(4 * i + j)] = static_cast<char>('0' + parts[j]);
    }
  }
  [[nodiscard]] const char* of(uint32_t value) const { return &digits[4 * value]; }
};

/// Writes numbers as text, four digits at a time from a table. The upper digits of times, which rarely change, are
/// copied from the previous line.
class LineWriter {
 public:
  char* put_coordinate(char* out, uint32_t value) const {
    if (value >= 10000) return std::to_chars(out, out + 8, value).ptr;
    const uint32_t zeros = 3u - (value >= 10) - (value >= 100) - (value >= 1000);
    std::memcpy(out, table().of(value) + zeros, 4);
    return out + (4 - zeros);
  }

  char* put_time(char* out, int64_t t_us) {
    if (t_us < 10000) return std::to_chars(out, out + 21, t_us).ptr;
    const int64_t upper = t_us / 10000;
    if (upper != upper_) set_upper(upper);
    std::memcpy(out, upper_text_.data(), upper_text_.size());
    out += upper_size_;
    std::memcpy(out, table().of(static_cast<uint32_t>(t_us - upper * 10000)), 4);
    return out + 4;
  }

 private:
  static const DigitTable& table() {
    static const DigitTable digits;
    return digits;
  }

  /// The digits before the last four.
  void set_upper(int64_t upper) {
    upper_ = upper;
    upper_size_ =
        static_cast<size_t>(std::to_chars(upper_text_.data(), upper_text_.data() + 20, upper).ptr - upper_text_.data());
  }

  int64_t upper_ = -1;
  std::array<char, 24> upper_text_{};
  size_t upper_size_ = 0;
};

/// Writes events [begin, end) as lines and returns the end of the text; `out` has kLongestWrittenLine bytes for each.
char* format_lines(const EventColumns& events, size_t begin, size_t end, char* out) {
  LineWriter writer;
  for (size_t i = begin; i < end; ++i) {
    out = writer.put_coordinate(out, events.x[i]);
    *out++ = ',';
    out = writer.put_coordinate(out, events.y[i]);
    *out++ = ',';
    *out++ = static_cast<char>('0' + events.p[i]);
    *out++ = ',';
    out = writer.put_time(out, events.t[i]);
    *out++ = '\n';
  }
  return out;
}

class CsvWriter final : public RecordingWriter {
 public:
  CsvWriter(SinkPtr sink, const RecordingInfo& info)
      : sink_(std::move(sink)), check_(info.width, info.height, sink_->name()) {}

  Result<void> begin(const RecordingInfo& info) {
    const bool has_size = info.width != 0 && info.height != 0;
    return sink_->write(
        as_bytes(has_size ? cat("%geometry:", info.width, ',', info.height, '\n') : std::string("%x,y,p,t\n")));
  }

  bool holds_triggers() const override { return false; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    format(batch.events);
    // The sink writes the previous text while the next one is formatted.
    E2LF_RETURN_IF_ERROR(finish_writing());
    std::swap(text_, written_);
    if (num_threads() == 1) return write_out();
    writing_ = std::async(std::launch::async, [this] { return write_out(); });
    return {};
  }

  Result<void> finish() override {
    E2LF_RETURN_IF_ERROR(finish_writing());
    return sink_->commit();
  }

 private:
  /// Lines in parts of one buffer.
  struct Text {
    Column<char> buffer;
    std::vector<std::span<const uint8_t>> pieces;
  };

  /// Sets text_; each part of the batch is formatted into its own part of the buffer.
  void format(const EventColumns& events) {
    const size_t count = events.size();
    const size_t parts = std::clamp<size_t>(count / kMinEventsPerThread, 1, 4 * static_cast<size_t>(num_threads()));
    if (text_.buffer.size() < count * kLongestWrittenLine) text_.buffer.resize(count * kLongestWrittenLine);
    text_.pieces.resize(parts);
    const auto begin_of = [&](size_t part) { return count * part / parts; };
    parallel_for(parts, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) {
        char* const begin = text_.buffer.data() + begin_of(i) * kLongestWrittenLine;
        const char* const end = format_lines(events, begin_of(i), begin_of(i + 1), begin);
        text_.pieces[i] = {reinterpret_cast<const uint8_t*>(begin), static_cast<size_t>(end - begin)};
      }
    });
  }

  Result<void> write_out() {
    for (const auto& piece : written_.pieces) E2LF_RETURN_IF_ERROR(sink_->write(piece));
    return {};
  }

  Result<void> finish_writing() { return writing_.valid() ? writing_.get() : Result<void>(); }

  SinkPtr sink_;
  BatchCheck check_;
  Text text_, written_;
  std::future<Result<void>> writing_;  ///< writes written_; last, because it uses the members above
};

}  // namespace

Result<WriterPtr> create_csv(SinkPtr sink, const RecordingInfo& info) {
  auto writer = std::make_unique<CsvWriter>(std::move(sink), info);
  E2LF_RETURN_IF_ERROR(writer->begin(info));
  return WriterPtr(std::move(writer));
}

}  // namespace e2lf::formats::text
