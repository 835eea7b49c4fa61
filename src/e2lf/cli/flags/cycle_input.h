// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/verb.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::cli {

/// Opens event images, another measurement, or a recording, whose cycles are passed to `confidence`. Fails as
/// CycleInput::create() does, and with kInvalidValue if flags for recordings are given for a measurement.
[[nodiscard]] Result<pipeline::CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                                            size_t cycles_per_field, const Verb& verb,
                                                            ConfidenceWatch& confidence);

/// Sets the number of patterns that the cycles of a recording must have for the model or patterns of the caller.
[[nodiscard]] CycleFlags wanted_cycles(CycleFlags flags, const pipeline::MethodChoice& choice);

/// Converts an error of the pipeline for the user: replaces the option in its location by the flag, or an empty
/// location by the input.
[[nodiscard]] Error by_flag(Error error, const std::filesystem::path& input);

}  // namespace e2lf::cli
