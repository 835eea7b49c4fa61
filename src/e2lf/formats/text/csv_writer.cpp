// SPDX-License-Identifier: MIT
// Writes text tables; declared in codecs.h.
#include <algorithm>
#include <charconv>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::formats::text {
namespace {

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

  Result<void> begin(const RecordingInfo& info) {
    const bool has_size = info.width != 0 && info.height != 0;
    return sink_->write(
        as_bytes(has_size ? cat("%geometry:", info.width, ',', info.height, '\n') : std::string("%x,y,p,t\n")));
  }

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

Result<WriterPtr> create_csv(SinkPtr sink, const RecordingInfo& info) {
  auto writer = std::make_unique<CsvWriter>(std::move(sink), info);
  E2LF_RETURN_IF_ERROR(writer->begin(info));
  return WriterPtr(std::move(writer));
}

}  // namespace e2lf::formats::text
