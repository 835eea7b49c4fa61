// SPDX-License-Identifier: MIT
#include "e2lf/cycles/polarity_check.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace e2lf::cycles {
namespace {

constexpr double kLeastSignedEvents = 500;  // for the patterns with stated signs
constexpr double kLeastAgreement = 0.15;    // of their signs, which ranges from -1 to 1
// The ratio between the events after black and after white. Recordings synthesised from event images have artificial
// events in one half of the cycle, at most three times those in the other.
constexpr double kClearRatio = 4;

/// Returns the agreement from -1, where all signs are opposite to the schedule, to 1, or nothing if there are too few
/// events.
std::optional<double> sign_agreement(const Schedule& schedule, std::span<const PatternEvents> events) {
  double agreeing = 0, all = 0;
  for (size_t i = 0; i < schedule.size(); ++i) {
    const BurstSign sign = schedule.patterns[i].sign;
    if (sign == BurstSign::kAny) continue;
    agreeing += (sign == BurstSign::kOn ? 1.0 : -1.0) * events[i].net();
    all += static_cast<double>(events[i].on + events[i].off);
  }
  if (all < kLeastSignedEvents) return std::nullopt;
  return agreeing / all;
}

/// Returns the first pattern of `sign` that is followed by one of the opposite sign.
std::optional<size_t> find_extreme(const Schedule& schedule, BurstSign sign, BurstSign next_sign) {
  for (size_t i = 0; i < schedule.size(); ++i) {
    const BurstSign next = schedule.patterns[(i + 1) % schedule.size()].sign;
    if (schedule.patterns[i].sign == sign && next == next_sign) return i;
  }
  return std::nullopt;
}

/// Returns the ratio of the events between black and white to those between white and black, or nothing if the schedule
/// does not contain both.
std::optional<double> strength_after_black(const Schedule& schedule, std::span<const PatternEvents> events) {
  const auto black = find_extreme(schedule, BurstSign::kOff, BurstSign::kOn);
  const auto white = find_extreme(schedule, BurstSign::kOn, BurstSign::kOff);
  if (!black || !white) return std::nullopt;
  const auto between = [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = (begin + 1) % schedule.size(); i != end; i = (i + 1) % schedule.size()) {
      sum += static_cast<double>(events[i].on + events[i].off);
    }
    return sum;
  };
  return between(*black, *white) / std::max(between(*white, *black), 1.0);
}

}  // namespace

CyclePolarity polarity_of(const Schedule& schedule, std::span<const PatternEvents> events) {
  const auto agreement = sign_agreement(schedule, events);
  if (!agreement || std::abs(*agreement) < kLeastAgreement) return CyclePolarity::kUnknown;
  const bool agrees = *agreement > 0;
  const auto strength = strength_after_black(schedule, events);
  if (!strength) return agrees ? CyclePolarity::kRight : CyclePolarity::kInverted;
  if (*strength > kClearRatio) return agrees ? CyclePolarity::kRight : CyclePolarity::kInverted;
  if (*strength < 1 / kClearRatio) return agrees ? CyclePolarity::kInverted : CyclePolarity::kHalfCycleOff;
  return CyclePolarity::kUnknown;
}

}  // namespace e2lf::cycles
