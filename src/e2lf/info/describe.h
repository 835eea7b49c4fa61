// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::info {

/// The description of a file or folder.
struct Description {
  Json json;                 ///< all that is known
  std::string note = {};     ///< what can be done with it, or a drawing
  std::string failure = {};  ///< what ended live input before its end

  /// Returns the table of all that is known with the note, in characters that are safe on a terminal.
  [[nodiscard]] std::string text() const;
};

/// Returns the options for all views of a light field as they are stored.
[[nodiscard]] inline lightfield::ReadOptions whole_light_field() {
  lightfield::ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  options.colour = true;
  options.range = lightfield::RangePolicy::kKeep;
  return options;
}

struct DescribeOptions {
  recordings::OpenOptions recording = {};
  lightfield::ReadOptions light_field = whole_light_field();
  /// Receives the number of events of a recording that have been read; the total is unknown and given as 0.
  ProgressFn progress = {};
  std::function<void(const recordings::EventBatch&)> on_batch = {};  ///< called with all events of a recording
};

/// Describes an input of any kind that file_kind() distinguishes. Fails as reading it does.
[[nodiscard]] Result<Description> describe(const std::filesystem::path& path, const DescribeOptions& options);
[[nodiscard]] Result<Description> describe(FileKind kind, const std::filesystem::path& path,
                                           const DescribeOptions& options);

/// Reads a whole recording and describes it: format, sensor, events, triggers, duration, event rate and damage. Needs
/// constant memory.
[[nodiscard]] Result<Description> describe_recording(const std::filesystem::path& path, const DescribeOptions& options);

}  // namespace e2lf::info
