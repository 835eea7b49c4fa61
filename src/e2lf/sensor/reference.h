// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {

/// Plain scalar versions of coded_intensities() and simulate_events() on one thread, with the logarithm and
/// trigonometry of the C library. Tests and benchmarks compare the fast versions with them. Coded intensities are
/// bit-identical. Event counts are equal unless a quotient lies within rounding of a whole number (about one in a
/// million).
[[nodiscard]] Result<CodedIntensities> reference_coded_intensities(const capture::Codes& codes,
                                                                   const lightfield::LightField& light_field);
[[nodiscard]] Result<capture::EventImages> reference_simulate_events(const CodedIntensities& intensities,
                                                                     const EventModelOptions& options);

}  // namespace e2lf::sensor
