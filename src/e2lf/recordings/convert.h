// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

struct ConvertOptions {
  std::string format = {};   ///< of the output; empty = by its extension
  ProgressFn progress = {};  ///< called with the events written so far; the total is not known and 0
};

struct ConvertReport {
  uint64_t events = 0;
  uint64_t triggers = 0;               ///< written
  uint64_t lost_triggers = 0;          ///< neither the format nor the place has room for them: text to a pipe
  std::filesystem::path trigger_file;  ///< where triggers went that the format does not hold: a name beside the
                                       ///< output; empty = none
  std::vector<std::string> warnings;   ///< what the output cannot hold, for people; also logged
  DecodeSummary summary;               ///< of the input: what was left out of it
};

/// Copies what is left of a recording into a new file, in bounded memory where the formats allow it. Triggers that the
/// output's format cannot hold go to <name>_triggers.csv, with a warning; so does a warning for times that will not
/// come back as they are. Fails as the reader and create_recording() do, and with
/// kInvalidValue where there is neither an event nor a trigger; the output then does not appear.
[[nodiscard]] Result<ConvertReport> convert_recording(RecordingReader& reader, const std::filesystem::path& output,
                                                      const ConvertOptions& options = {});

}  // namespace e2lf::recordings
