// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/cli/output/run_record.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::cli {

/// Says which bundled network was taken since no model was named.
void say_bundled_network(const pipeline::BundledNetwork& network);

/// Logs and records what was decided on the way to a method for `events`: the network or patterns that were taken where
/// none was named, who told patterns and sensor profile, and where these are not what the method is for. `model` is the
/// file that the user named, and `passes` the number that was asked for.
void note_method(const pipeline::OpenedMethod& method, const std::filesystem::path& events,
                 const std::filesystem::path& model, size_t passes, RunRecord& record);

}  // namespace e2lf::cli
