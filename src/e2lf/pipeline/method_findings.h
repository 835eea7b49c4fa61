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

/// Returns the finding that the patterns of the caller are not those that the events state, if both are known. Either
/// may be the patterns of a cycle or those of all its transitions.
[[nodiscard]] std::optional<diagnose::Finding> contradicted_codes(const std::optional<capture::Codes>& of_caller,
                                                                  const std::optional<capture::Codes>& of_events);

}  // namespace e2lf::pipeline
