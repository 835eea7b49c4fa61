// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/cli/output/run_record.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::cli {

/// Logs which bundled network was chosen because no model was given.
void say_bundled_network(const pipeline::BundledNetwork& network);

/// Logs and records the decisions behind a method for `events`: the network or patterns that were chosen by default,
/// the sources of the patterns and the sensor profile, and any mismatch between these and the method. `model` is the
/// file that the user gave, and `passes` the requested number of passes.
void note_method(const pipeline::OpenedMethod& method, const std::filesystem::path& events,
                 const std::filesystem::path& model, size_t passes, RunRecord& record);

}  // namespace e2lf::cli
