// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/files/output.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::recordings {

/// Returns the rules for an output that is made from these inputs, which are named as open_named_recording() takes
/// them: files, replayed recordings, pipes and cameras. The output is live if the first input is not a file.
[[nodiscard]] OutputRules output_rules(const std::vector<std::filesystem::path>& inputs, bool overwrite);

/// Returns the same rules for a recording of this format, with its file of triggers.
[[nodiscard]] OutputRules recording_output_rules(const std::vector<std::filesystem::path>& inputs, bool overwrite,
                                                 const Codec& codec);

/// Returns the function that saves the finished part of a recording in this format.
[[nodiscard]] Recover recover_recording(const Codec& codec);

}  // namespace e2lf::recordings
