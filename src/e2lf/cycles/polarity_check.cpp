// SPDX-License-Identifier: MIT
#include "e2lf/cycles/polarity_check.h"

#include <cmath>
#include <optional>

namespace e2lf::cycles {
namespace {

constexpr double kLeastEvents = 500;      // of the patterns whose signs are stated
constexpr double kLeastAgreement = 0.15;  // of their signs, from -1 to 1
constexpr double kLeastRatio = 1.5;       // between the changes after black and after white

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

/// How many times the change after black exceeds that after white; nothing where the schedule does not show both.
std::optional<double> strength_after_black(const Schedule& schedule, std::span<const PatternEvents> events) {
  std::optional<double> after_black, after_white;
  for (size_t i = 0; i < schedule.size(); ++i) {
    const size_t next = (i + 1) % schedule.size();
    const BurstSign sign = schedule.patterns[i].sign, next_sign = schedule.patterns[next].sign;
    const double change = std::abs(events[next].net());
    if (sign == BurstSign::kOff && next_sign == BurstSign::kOn) after_black = change;
    if (sign == BurstSign::kOn && next_sign == BurstSign::kOff) after_white = change;
  }
  // With two codes or none between them, white follows black at once: then both are the same changes.
  if (!after_black || !after_white || schedule.size() < 4) return std::nullopt;
  return *after_black / std::max(*after_white, 1.0);
}

}  // namespace

CyclePolarity polarity_of(const Schedule& schedule, std::span<const PatternEvents> events) {
  const auto agreement = sign_agreement(schedule, events);
  if (!agreement || std::abs(*agreement) < kLeastAgreement) return CyclePolarity::kUnknown;
  const bool agrees = *agreement > 0;
  const auto strength = strength_after_black(schedule, events);
  if (!strength) return agrees ? CyclePolarity::kRight : CyclePolarity::kInverted;
  if (*strength > kLeastRatio) return agrees ? CyclePolarity::kRight : CyclePolarity::kInverted;
  if (*strength < 1 / kLeastRatio) return agrees ? CyclePolarity::kInverted : CyclePolarity::kHalfCycleOff;
  return CyclePolarity::kUnknown;
}

}  // namespace e2lf::cycles
