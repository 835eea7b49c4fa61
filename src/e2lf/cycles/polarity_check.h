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

/// The polarity of a cycle according to its events.
enum class CyclePolarity {
  kUnknown,       ///< the schedule states no signs, or there are too few events
  kRight,         ///< the signs are those of the schedule
  kInverted,      ///< ON and OFF are exchanged
  kHalfCycleOff,  ///< the patterns are mistaken for their inverses
};

/// Compares the events of a whole cycle, with one entry per pattern of the schedule, with the signs that the schedule
/// states. A display that shows each pattern and its inverse has the same intervals in both halves of its cycle, so
/// that inverted signs alone look like the other half. The strength distinguishes them: the changes after black cause
/// many times the events of the changes after white, because pixels respond to relative changes. Both criteria are
/// therefore combined.
[[nodiscard]] CyclePolarity polarity_of(const Schedule& schedule, std::span<const PatternEvents> events);

}  // namespace e2lf::cycles
