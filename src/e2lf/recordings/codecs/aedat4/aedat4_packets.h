// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings::aedat4 {

/// Appends the events of an unpacked EVTS packet. False when it is not one, or cut; nothing is appended then.
/// Coordinates that are negative come out as 65535, beyond any sensor.
[[nodiscard]] bool append_events(std::span<const uint8_t> packet, EventColumns& events);

/// Appends the external signals of an unpacked TRIG packet. False when it is not one.
[[nodiscard]] bool append_triggers(std::span<const uint8_t> packet, std::vector<Trigger>& triggers);

}  // namespace e2lf::recordings::aedat4
