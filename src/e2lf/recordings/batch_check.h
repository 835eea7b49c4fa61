// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Checks batches as RecordingWriter::write() requires, in the same way for all formats.
class BatchCheck {
 public:
  /// `width` and `height` are the size of the sensor, px; 0 = unlimited. `name` is the location in errors.
  BatchCheck(size_t width, size_t height, std::string name) : width_(width), height_(height), name_(std::move(name)) {}

  /// Fails with kInvalidValue for an event outside the sensor, for p above 1, and for times that decrease within the
  /// batch or since the last one.
  [[nodiscard]] Result<void> operator()(const EventBatch& batch);

 private:
  [[nodiscard]] Error find_error(const EventColumns& events) const;

  size_t width_, height_;
  std::string name_;
  int64_t last_event_us_ = INT64_MIN;
  int64_t last_trigger_us_ = INT64_MIN;
  uint64_t events_done_ = 0;
};

/// Returns whether events lie inside a sensor of this size (0 = unlimited), have polarities 0 or 1, and are in order of
/// time.
[[nodiscard]] bool is_in_order(const EventColumns& events, size_t width, size_t height);

/// Sets the size in `info` from the options if the file does not state it. Fails with kInvalidValue if both state it
/// and differ; `name` is the location.
[[nodiscard]] Result<void> apply_size_option(const OpenOptions& options, RecordingInfo& info, const std::string& name);

/// Fails with kInvalidValue if options for tables are given although the format fixes what they specify.
[[nodiscard]] Result<void> refuse_table_options(const OpenOptions& options, const std::string& format,
                                                const std::string& name);

}  // namespace e2lf::recordings
