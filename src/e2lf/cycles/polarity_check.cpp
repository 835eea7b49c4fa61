// SPDX-License-Identifier: MIT
#include "e2lf/cycles/polarity_check.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace e2lf::cycles {
namespace {

constexpr double kLeastEvents = 500;      // of the patterns whose signs are stated
constexpr double kLeastAgreement = 0.15;  // of their signs, from -1 to 1
// Between the events after black and after white. Recordings that are made of event images have made-up events in the
// one half of the cycle, at most three times those of the other.
constexpr double kClearRatio = 4;

/// From -1, where all signs are the opposite of what the schedule says, to 1; nothing where there are too few events.
std::optional<double> sign_agreement(const Schedule& schedule, std::span<const PatternEvents> events) {
  double agreeing = 0, all = 0;
  for (size_t i = 0; i < schedule.size(); ++i) {
    const BurstSign sign = schedule.patterns[i].sign;
    if (sign == BurstSign::kAny) continue;
    agreeing += (sign == BurstSign::kOn ? 1.0 : -1.0) * events[i].net();
    all += static_cast<double>(events[i].on + events[i].off);
  }
  if (all < kLeastEvents) return std::nullopt;
  return agreeing / all;
}

/// The first pattern of `sign` that one of the opposite sign follows.
std::optional<size_t> find_extreme(const Schedule& schedule, BurstSign sign, BurstSign next_sign) {
  for (size_t i = 0; i < schedule.size(); ++i) {
    const BurstSign next = schedule.patterns[(i + 1) % schedule.size()].sign;
    if (schedule.patterns[i].sign == sign && next == next_sign) return i;
  }
  return std::nullopt;
}

/// How many times the events between black and white exceed those between white and black; nothing where the schedule
/// does not show both.
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
