// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/verb.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::cli {

/// Opens event images, another measurement or a recording, whose cycles `confidence` watches. Fails as
/// CycleInput::create() does, and with kInvalidValue where flags of recordings are given for a measurement.
[[nodiscard]] Result<pipeline::CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                                            size_t cycles_per_field, const Verb& verb,
                                                            ConfidenceWatch& confidence);

/// Completes the flags by what cycles of a recording must have for the patterns that the caller names.
[[nodiscard]] CycleFlags wanted_cycles(CycleFlags flags, const pipeline::MethodChoice& choice);

/// An error of the pipeline: the option that it names as the flag, or else the input where it names nothing.
[[nodiscard]] Error by_flag(Error error, const std::filesystem::path& input);

}  // namespace e2lf::cli
