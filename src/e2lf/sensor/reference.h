// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {

/// Plain scalar versions of coded_intensities() and simulate_events() on one thread, with the C library's logarithm and
/// trigonometry: what the fast ones are tested against and compared with in benchmarks. Coded intensities are equal bit
/// for bit. Event counts are equal but where a quotient falls within rounding of a whole number (about one in a
/// million).
[[nodiscard]] Result<CodedIntensities> reference_coded_intensities(const capture::Codes& codes,
                                                                   const lightfield::LightField& light_field);
[[nodiscard]] Result<capture::EventImages> reference_simulate_events(const CodedIntensities& intensities,
                                                                     const EventModelOptions& options);

}  // namespace e2lf::sensor
