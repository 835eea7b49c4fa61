// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Appends a little-endian word.
template <typename Word>
void put_word(std::vector<uint8_t>& out, Word word) {
  for (size_t i = 0; i < sizeof(Word); ++i) out.push_back(static_cast<uint8_t>(word >> (8 * i)));
}

/// Generates the words with the upper bits of the time, those in kMask above the low kLowBits: one at every step, and a
/// repetition after 16 us. Pauses of up to kMaxFilled steps are filled step by step, longer ones in steps of kMaxStep.
template <unsigned kLowBits, uint32_t kMask, int64_t kMaxStep, int64_t kMaxFilled = INT64_MAX>
class HighTimes {
 public:
  /// Calls put(upper bits) for each word that must precede an event at `t_us`.
  template <typename Put>
  void advance(int64_t t_us, const Put& put) {
    constexpr int64_t kHeartbeatUs = 16;
    const int64_t high = t_us >> kLowBits;
    if (high == high_ && t_us - written_us_ < kHeartbeatUs) return;
    const auto put_steps = [&put](int64_t from, int64_t end, int64_t step) {
      for (; from < end; from += step) put(static_cast<uint32_t>(from) & kMask);
    };
    const bool is_filled = high_ >= 0 && high > high_ && high - high_ <= kMaxFilled;
    // A recording that begins beyond the range of the clock first counts its loops.
    if (high_ < 0 && high > kMask) put_steps(kMaxStep, high, kMaxStep);
    if (high_ >= 0 && !is_filled) put_steps(high_ + kMaxStep, high, kMaxStep);
    put_steps(is_filled ? high_ + 1 : high, high + 1, 1);
    high_ = high;
    written_us_ = t_us;
  }

 private:
  int64_t high_ = -1;
  int64_t written_us_ = 0;
};

/// Writes a RAW recording: the header, then events and triggers, merged by time and encoded by an Encoder:
///   Encoder(info)
///   kFormat                             the name of the encoding in e2lf
///   kMaxFirstUs                         the latest time of the first event
///   kMaxPauseUs                         the longest time without events and triggers
///   kMaxTriggerId
///   put_events(events, begin, end, out) encodes events[begin, end)
///   put_trigger(trigger, out)           encodes a trigger
template <typename Encoder>
class RawWriter final : public RecordingWriter {
 public:
  RawWriter(SinkPtr sink, const RecordingInfo& info)
      : sink_(std::move(sink)), name_(sink_->name()), check_(info.width, info.height, name_), encoder_(info) {}

  [[nodiscard]] bool holds_triggers() const override { return true; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check(batch));
    buffer_.clear();
    size_t event = 0;
    for (const Trigger& trigger : batch.triggers) {
      size_t end = event;
      while (end < batch.events.size() && batch.events.t[end] < trigger.t) ++end;
      encoder_.put_events(batch.events, event, end, buffer_);
      encoder_.put_trigger(trigger, buffer_);
      event = end;
    }
    encoder_.put_events(batch.events, event, batch.events.size(), buffer_);
    return sink_->write(buffer_);
  }

  Result<void> finish() override { return sink_->commit(); }

 private:
  Result<void> check(const EventBatch& batch) {
    const int64_t first_us = batch.first_us(), last_us = std::max(latest_us_, batch.last_us());
    if (first_us < 0 || (latest_us_ < 0 && first_us > Encoder::kMaxFirstUs && !batch.empty())) {
      return Error{ErrorCode::kInvalidValue,
                   cat("time ", first_us, " us cannot be stored in this format; begin at zero"), name_, "shift_time"};
    }
    for (const Trigger& trigger : batch.triggers) {
      if (trigger.id <= Encoder::kMaxTriggerId) continue;
      return fail(ErrorCode::kInvalidValue, name_, "trigger id ", trigger.id,
                  " does not fit into this encoding, which ends at ", Encoder::kMaxTriggerId,
                  "; write HDF5 or npz instead");
    }
    if (first_us < latest_us_) {
      return fail(ErrorCode::kInvalidValue, name_, "time runs back from ", latest_us_, " to ", first_us,
                  " us; sort events and triggers first");
    }
    E2LF_RETURN_IF_ERROR(check_(batch));
    if (latest_us_ < 0) latest_us_ = std::min(first_us, last_us);
    if (last_us - latest_us_ > Encoder::kMaxPauseUs) E2LF_RETURN_IF_ERROR(check_pauses(batch));
    latest_us_ = last_us;
    return {};
  }

  Result<void> check_pauses(const EventBatch& batch) const {
    std::vector<int64_t> times_us(batch.events.t.begin(), batch.events.t.end());
    for (const Trigger& trigger : batch.triggers) times_us.push_back(trigger.t);
    std::sort(times_us.begin(), times_us.end());
    int64_t last_us = latest_us_;
    for (const int64_t t_us : times_us) {
      if (t_us - last_us > Encoder::kMaxPauseUs) {
        return fail(ErrorCode::kInvalidValue, name_, "the pause from ", last_us, " to ", t_us,
                    " us is longer than the ", Encoder::kMaxPauseUs,
                    " us that this encoding can store; split the recording or write HDF5");
      }
      last_us = t_us;
    }
    return {};
  }

  SinkPtr sink_;
  std::string name_;
  BatchCheck check_;
  Encoder encoder_;
  std::vector<uint8_t> buffer_;
  int64_t latest_us_ = -1;  ///< latest time that was written; -1 = nothing yet
};

/// Creates a writer: checks the size and writes the header of the format Encoder::kFormat. Fails with kInvalidValue and
/// kIo.
template <typename Encoder>
Result<WriterPtr> create_raw_writer(SinkPtr sink, const RecordingInfo& info) {
  if (info.width == 0 || info.height == 0 || info.width > 2048 || info.height > 2048) {
    return Error{ErrorCode::kInvalidValue,
                 cat("a RAW recording is 1 to 2048 px wide and high, not ", info.width, "x", info.height,
                     "; give the sensor's size"),
                 sink->name(), "sensor_width"};
  }
  RecordingInfo raw = info;
  raw.format = Encoder::kFormat;
  const std::string header = raw_header_text(raw);
  E2LF_RETURN_IF_ERROR(sink->write(as_bytes(header)));
  return WriterPtr(std::make_unique<RawWriter<Encoder>>(std::move(sink), raw));
}

}  // namespace e2lf::recordings
