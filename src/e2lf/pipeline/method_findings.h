// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::pipeline {

/// Returns where a method does not match the events that it is opened for: patterns that are assumed or are not those
/// of the network, physical pixels that it was not trained for, and passes that it cannot make.
[[nodiscard]] diagnose::Findings method_findings(const OpenedMethod& method, const MethodUse& use);

/// Returns the finding that the gain which was determined from a light field is far from 1, so that its brightness is
/// not that of the scenes for which the method was made.
[[nodiscard]] std::optional<diagnose::Finding> gain_finding(const OpenedMethod& method, float gain);

/// The patterns that each source states, or nothing.
struct StatedCodes {
  std::optional<capture::Codes> caller, events, schedule;
};

/// Returns the finding that two sources state different patterns. Each may state those of a cycle or those of all its
/// transitions.
[[nodiscard]] std::optional<diagnose::Finding> contradicted_codes(const StatedCodes& stated);

}  // namespace e2lf::pipeline
