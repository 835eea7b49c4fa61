// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/verb.h"

namespace e2lf::cli {

struct RecordingInfoOptions {
  std::filesystem::path plot;  ///< SVG of the event rate; empty = none
  std::string format;          ///< empty = detected
  int64_t from_us = INT64_MIN, to_us = INT64_MAX;
};

/// Decodes a whole recording and prints what it holds: format, sensor, events, triggers, duration, rate, and what
/// was damaged. Constant memory.
[[nodiscard]] Result<void> print_recording_info(const std::filesystem::path& path, const RecordingInfoOptions& options,
                                                const CommonOptions& common);

}  // namespace e2lf::cli
