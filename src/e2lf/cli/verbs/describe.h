// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/cli/flags/file_kind.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/cli/flags/recording_flags.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/event.h"
#include "e2lf/report/page.h"

namespace e2lf::cli {

/// The description of a file or folder: text for people, JSON for scripts, and images for a page, if there are any.
struct Description {
  std::string text;
  Json json;
  std::function<Result<void>(report::Page&)> show = {};
  std::string failure = {};  ///< what ended live input before its end
};

struct DescribeOptions {
  RecordingFlags recording;
  LightFieldFlags light_field{.views = 0};
  /// Receives the number of events of a recording that have been read; the total is unknown and given as 0.
  ProgressFn progress = {};
  std::function<void(const recordings::EventBatch&)> on_batch = {};  ///< called with all events of a recording
};

/// Describes an input of any kind that file_kind() distinguishes. Fails as reading it does.
[[nodiscard]] Result<Description> describe(const std::filesystem::path& path, const DescribeOptions& options);
[[nodiscard]] Result<Description> describe(FileKind kind, const std::filesystem::path& path,
                                           const DescribeOptions& options);

/// Describes a file of settings: a camera, a schedule, patterns, the record of a run, settings of a training, or
/// biases.
[[nodiscard]] Result<Description> describe_settings(const std::filesystem::path& path);

/// Returns counts, times, and the data that were dropped.
[[nodiscard]] Json summary_json(const recordings::DecodeSummary& summary);

/// Reads a whole recording and describes it: format, sensor, events, triggers, duration, event rate and damage. Needs
/// constant memory.
[[nodiscard]] Result<Description> describe_recording(const std::filesystem::path& path, const DescribeOptions& options);

/// Collects statistics of the triggers of a recording and the extent of its events, in constant memory.
class RecordingStatistics {
 public:
  void add(const recordings::EventBatch& batch);

  /// Returns the size in px of the smallest sensor that contains all events, or 0 if there are none.
  [[nodiscard]] size_t width() const { return width_; }
  [[nodiscard]] size_t height() const { return height_; }

  /// Returns the number of rising and falling edges of each trigger input and the mean time between them.
  [[nodiscard]] Json triggers_json() const;
  [[nodiscard]] std::string triggers_text() const;

 private:
  struct Edges {
    uint64_t count = 0;
    int64_t first_us = 0, last_us = 0;
    void add(int64_t t_us);
    [[nodiscard]] double period_us() const;
  };
  struct Channel {
    Edges rising, falling;
  };
  std::map<uint16_t, Channel> channels_;
  size_t width_ = 0, height_ = 0;
};

}  // namespace e2lf::cli
