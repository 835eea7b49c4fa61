// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/codes.h"
#include "e2lf/cli/run_record.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cli {

/// Keeps the patterns of a recording that was just written in its run record, for formats whose header has no room.
void note_recorded_codes(RunRecord& record, const capture::Codes& codes, const std::filesystem::path& recording);

/// The patterns that a recording was made with: those of its header, else those of the run record beside it, where that
/// is of a recording of this size. Nothing when neither tells. Fails as capture::codes_from_header() does.
[[nodiscard]] Result<std::optional<capture::Codes>> recorded_codes(const std::filesystem::path& recording,
                                                                   const recordings::RecordingInfo& info);

}  // namespace e2lf::cli
