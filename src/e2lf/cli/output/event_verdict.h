// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/files/options.h"
#include "e2lf/recon/event_judgement.h"

namespace e2lf::cli {

/// The judgement of a light field by its events for the record: {"verdict", "error", "noise_error", "ratio", ...}.
[[nodiscard]] Json check_json(const recon::EventJudgement& judgement);

/// Prints how far the light field of a recorded cycle is from explaining its events, and what that means.
void print_event_error(const Json& cycle);

/// Warns where the judgement of a recorded cycle is that something is likely wrong, and says what to do.
void warn_of_verdict(const Json& cycle);

}  // namespace e2lf::cli
