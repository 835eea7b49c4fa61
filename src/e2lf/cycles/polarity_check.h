// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "e2lf/cycles/schedule.h"

namespace e2lf::cycles {

/// The events from the change to a pattern until the next change.
struct PatternEvents {
  uint64_t on = 0, off = 0;

  [[nodiscard]] double net() const { return static_cast<double>(on) - static_cast<double>(off); }
};

/// What the events of a cycle say of their signs.
enum class CyclePolarity {
  kUnknown,       ///< the schedule names no signs, or there are too few events
  kRight,         ///< the signs are those of the schedule
  kInverted,      ///< ON and OFF have changed places
  kHalfCycleOff,  ///< the patterns are taken for their inverses
};

/// Compares the events of a whole cycle, one entry for each pattern of the schedule, with the signs that the schedule
/// states. A display that shows each pattern and its inverse makes the same intervals in both halves of its cycle, so
/// that inverted signs alone look like the other half. What differs is the strength: the changes after black make many
/// times the events of the changes after white, as pixels respond to relative changes. So the two together tell.
[[nodiscard]] CyclePolarity polarity_of(const Schedule& schedule, std::span<const PatternEvents> events);

}  // namespace e2lf::cycles
