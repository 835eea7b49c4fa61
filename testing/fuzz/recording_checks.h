// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace e2lf::fuzz {

/// What every codec promises, whatever bytes it is given. Opens `bytes` as a recording of `format`, and where that
/// succeeds requires that
///   - events and triggers are sorted by time, events lie inside the sensor, batches hold no more than was asked for;
///   - scalar and vector kernels give the same, memory and a live source cut at odd places too;
///   - a seek gives the rest of the recording; times from zero differ by one constant;
///   - the strict policy fails exactly where damage was counted;
///   - what was decoded comes back unchanged from the formats it can be written in.
/// The input's hash chooses which of these is looked at.
void check_recording(const std::string& format, std::span<const uint8_t> bytes);

}  // namespace e2lf::fuzz
