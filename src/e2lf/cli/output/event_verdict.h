// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/files/options.h"
#include "e2lf/recon/event_judgement.h"

namespace e2lf::cli {

/// Returns the judgement of a light field for the record: {"verdict", "error", "noise_error", "ratio", ...}. If the
/// times of its cycle are doubtful, a favourable verdict is replaced by "unconfirmed": the light field may explain the
/// events of wrong times, too.
[[nodiscard]] Json check_json(const recon::EventJudgement& judgement, bool is_doubtful);

/// Returns a line on the difference between the events of a cycle of the record and those that its light field would
/// cause, with the verdict.
[[nodiscard]] std::string event_error_text(const Json& cycle);

/// Logs a warning with a remedy if the verdict on a cycle of the record is that something is probably wrong.
void warn_of_verdict(const Json& cycle);

}  // namespace e2lf::cli
