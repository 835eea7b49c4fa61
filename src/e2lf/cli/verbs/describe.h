// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/cli/flags/file_kind.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/cli/flags/recording_flags.h"
#include "e2lf/files/options.h"
#include "e2lf/report/page.h"

namespace e2lf::cli {

/// What a file or folder is: text for people, JSON for scripts, and pictures of it for a page where it has any.
struct Description {
  std::string text;
  Json json;
  std::function<Result<void>(report::Page&)> show = {};
  std::string failure = {};  ///< what ended live input before its end
};

struct DescribeOptions {
  RecordingFlags recording;
  LightFieldFlags light_field{.views = 0};
  ProgressFn progress = {};  ///< of a recording: events so far; the total is not known and 0
  std::function<void(const recordings::EventBatch&)> on_batch = {};  ///< sees all of a recording
};

/// Describes what file_kind() tells. Fails as reading that does.
[[nodiscard]] Result<Description> describe(const std::filesystem::path& path, const DescribeOptions& options);
[[nodiscard]] Result<Description> describe(FileKind kind, const std::filesystem::path& path,
                                           const DescribeOptions& options);

/// Describes a folder that is made of several things: a training run, the pictures of a display, results of a verb.
[[nodiscard]] Result<Description> describe_folder(FileKind kind, const std::filesystem::path& path);

/// What a reader has met: counts, times and what was left out.
[[nodiscard]] Json summary_json(const recordings::DecodeSummary& summary);

/// Reads a whole recording and says what it holds: format, sensor, events, triggers, duration, rate, and what was
/// damaged. Constant memory.
[[nodiscard]] Result<Description> describe_recording(const std::filesystem::path& path, const DescribeOptions& options);

}  // namespace e2lf::cli
