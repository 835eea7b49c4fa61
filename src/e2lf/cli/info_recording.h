// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/cli/recording_flags.h"
#include "e2lf/cli/verb.h"

namespace e2lf::cli {

struct RecordingInfoOptions {
  std::filesystem::path plot;  ///< SVG of the event rate; empty = none
  RecordingFlags flags;
};

/// Decodes a whole recording and prints what it holds: format, sensor, events, triggers, duration, rate, and what
/// was damaged. Constant memory.
[[nodiscard]] Result<void> print_recording_info(const std::filesystem::path& path, const RecordingInfoOptions& options,
                                                const CommonOptions& common);

}  // namespace e2lf::cli
