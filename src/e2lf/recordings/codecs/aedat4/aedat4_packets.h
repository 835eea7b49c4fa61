// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings::aedat4 {

/// Appends the events of a decompressed EVTS packet. Returns false, without appending any, if it is not one or is
/// truncated. Negative coordinates become 65535, which is outside any sensor.
[[nodiscard]] bool append_events(std::span<const uint8_t> packet, EventColumns& events);

/// Appends the external signals of a decompressed TRIG packet. Returns false if it is not one.
[[nodiscard]] bool append_triggers(std::span<const uint8_t> packet, std::vector<Trigger>& triggers);

}  // namespace e2lf::recordings::aedat4
