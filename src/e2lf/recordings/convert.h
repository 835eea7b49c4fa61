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
  std::string format = {};       ///< format of the output; empty = by its extension
  bool invert_polarity = false;  ///< whether to exchange ON and OFF
  ProgressFn progress = {};  ///< called with the number of events written so far; the total is unknown and given as 0
};

struct ConvertReport {
  uint64_t events = 0;
  uint64_t triggers = 0;       ///< written
  uint64_t lost_triggers = 0;  ///< lost because neither the format nor the destination can hold them: text to a pipe
  std::filesystem::path trigger_file;  ///< name of the file with triggers that the format cannot hold; empty = none
  std::vector<std::string> warnings;   ///< what the output cannot hold, as messages that are also logged
  DecodeSummary summary;               ///< summary of the input, with what was left out
};

/// Copies the rest of a recording to a new file, in bounded memory if the formats permit it. Triggers that the format
/// of the output cannot hold are written to <name>_triggers.csv, with a warning. Fails as the reader and
/// create_recording() do, and with kInvalidValue if there is neither an event nor a trigger, in which case no output
/// appears.
[[nodiscard]] Result<ConvertReport> convert_recording(RecordingReader& reader, const std::filesystem::path& output,
                                                      const ConvertOptions& options = {});

}  // namespace e2lf::recordings
