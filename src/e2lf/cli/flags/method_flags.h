// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "e2lf/cli/flags/inputs.h"
#include "e2lf/pipeline/field_sequence.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::cli {

/// The flags of the verbs that reconstruct light fields.
struct MethodFlags {
  CodesSource codes;
  std::string precision = "auto", gain = "auto", black = "auto", camera;
};

/// Declares -m, --codes, --camera, --precision, --gain and --black. `source` is what may state the camera.
void add_method_options(CLI::App& app, MethodFlags& flags, const std::string& source);

/// Reads the model and the patterns that the flags name, and takes over the precision. Fails as reading them does.
[[nodiscard]] Result<pipeline::MethodChoice> named_choice(const MethodFlags& flags, RunRecord& record);

/// Adds the setup of the events and the camera that the flags name. Warns if --codes and the events differ. Fails as
/// load_camera() does.
[[nodiscard]] Result<void> complete_choice(const MethodFlags& flags, capture::RecordedSetup events, RunRecord& record,
                                           pipeline::MethodChoice& choice);

/// Parses --gain (a positive number) and --black (a number of at least 0); "auto" leaves them to the method. Fails with
/// kInvalidValue.
[[nodiscard]] Result<pipeline::Tone> tone_of(const MethodFlags& flags);

}  // namespace e2lf::cli
