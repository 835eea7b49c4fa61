// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "e2lf/events/raw/raw_header.h"
#include "e2lf/events/raw/raw_stream.h"
#include "e2lf/events/recording.h"

namespace e2lf::events {

/// Reads a RAW recording of one encoding: bytes from a source through a RawStream. Every kCheckpointBytes the stream is
/// copied, so that seeking needs no index file: it goes on from the last copy before the time.
template <typename Codec>
class RawReader final : public RecordingReader {
 public:
  /// `source` stands behind the header.
  RawReader(std::unique_ptr<ByteSource> source, RawHeader header, const OpenOptions& options)
      : RecordingReader(options), source_(std::move(source)), stream_(limits_of(header.info)) {
    info_ = std::move(header.info);
    name_ = source_->name();
    checkpoints_.push_back({INT64_MIN, source_->position(), stream_});
  }

 protected:
  Result<bool> read_next(EventBatch& batch, size_t max_events) override {
    EventColumns& events = batch.events;
    const size_t known = events.size();
    events.resize(known + max_events + kSinkSlack);
    ColumnSink sink;
    sink.x = events.x.data() + known;
    sink.y = events.y.data() + known;
    sink.p = events.p.data() + known;
    sink.t = events.t.data() + known;
    sink.capacity = max_events;
    sink.set_latest(latest_us_);
    sink.triggers = &batch.triggers;
    sink.max_triggers = batch.triggers.size() + max_events;
    Result<bool> more = true;
    bool full = false;
    while (more && *more && !full && (source_->seekable() || sink.count == 0)) more = step(sink, full);
    events.resize(known + sink.count);
    latest_us_ = sink.latest();
    return more;
  }

  Result<bool> accumulate_next(std::span<const TimeSlice> slices, EventImages& images,
                               std::vector<Trigger>* triggers) override {
    ImageSink sink(slices, images, triggers);
    Result<bool> more = true;
    bool full = false;
    sink.set_latest(latest_us_);
    while (more && *more && !full) more = step(sink, full);
    sink.settle();
    latest_us_ = sink.latest();
    if (sink.on + sink.off > 0) {
      if (summary_.events() == 0) summary_.first_t_us = sink.first_t_us;
      summary_.last_t_us = sink.last_t_us;
    }
    summary_.events_on += sink.on;
    summary_.events_off += sink.off;
    summary_.triggers += sink.num_triggers;
    if (!more) return more;
    return full;
  }

  Result<void> seek_before(int64_t t_us) override {
    auto checkpoint = checkpoints_.rbegin();
    while (checkpoint->time_us >= t_us) ++checkpoint;
    E2LF_RETURN_IF_ERROR(source_->seek(checkpoint->byte));
    stream_ = checkpoint->stream;
    wanted_ = 1;
    latest_us_ = INT64_MIN;
    return {};
  }

 private:
  static constexpr uint64_t kCheckpointBytes = uint64_t{4} << 20;

  struct Checkpoint {
    int64_t time_us;
    uint64_t byte;
    RawStream<Codec> stream;
  };

  static SensorLimits limits_of(const RecordingInfo& info) {
    SensorLimits limits;
    if (info.width != 0) limits.width = static_cast<uint32_t>(info.width);
    if (info.height != 0) limits.height = static_cast<uint32_t>(info.height);
    return limits;
  }

  /// Decodes what is at hand; false at the end of the source, `full` when the sink stopped.
  template <typename Sink>
  Result<bool> step(Sink& sink, bool& full) {
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> bytes, source_->fetch(wanted_));
    const bool ended = bytes.size() < wanted_;
    const auto progress = stream_.process(bytes, ended, source_->position(), sink, summary_);
    source_->consume(progress.used);
    summary_.time_loops = stream_.time_loops();
    full = progress.wanted == 0 && !(ended && progress.used == bytes.size());
    wanted_ = std::max<size_t>(progress.wanted, 1);
    add_checkpoint();
    return full || !ended;
  }

  void add_checkpoint() {
    if (!source_->seekable() || source_->position() < checkpoints_.back().byte + kCheckpointBytes) return;
    if (stream_.time_us() <= checkpoints_.back().time_us) return;
    checkpoints_.push_back({stream_.time_us(), source_->position(), stream_});
  }

  std::unique_ptr<ByteSource> source_;
  RawStream<Codec> stream_;
  std::vector<Checkpoint> checkpoints_;
  size_t wanted_ = 1;
  int64_t latest_us_ = INT64_MIN;  ///< of what was given out
};

}  // namespace e2lf::events
