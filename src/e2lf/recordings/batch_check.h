// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// What RecordingWriter::write promises to refuse, for every format alike.
class BatchCheck {
 public:
  /// The sensor's size in pixels; 0 = unlimited. `name` is the location in errors.
  BatchCheck(size_t width, size_t height, std::string name) : width_(width), height_(height), name_(std::move(name)) {}

  /// Fails with kInvalidValue for an event outside the sensor, p above 1, or time that runs backwards, within the batch
  /// or against the batches before.
  [[nodiscard]] Result<void> operator()(const EventBatch& batch);

 private:
  [[nodiscard]] Error find_error(const EventColumns& events) const;

  size_t width_, height_;
  std::string name_;
  int64_t last_event_us_ = INT64_MIN;
  int64_t last_trigger_us_ = INT64_MIN;
  uint64_t events_done_ = 0;
};

/// Puts the size the caller gave into `info` where the file does not say. Fails with kInvalidValue where both say and
/// differ; `name` is the location.
[[nodiscard]] Result<void> apply_size_option(const OpenOptions& options, RecordingInfo& info, const std::string& name);

}  // namespace e2lf::recordings
