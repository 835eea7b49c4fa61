// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

/// Returns the same blocks, which must be in order of time, and warns at their end about implausible times: if up to
/// nine events at the beginning or the end are separated from all others by more than a hundred times the duration of
/// these, as after damage of a single time, or if all of a hundred events or more have the same time. Does not warn if
/// `options` select a range of times. `name` is the location.
[[nodiscard]] BlocksPtr make_lone_events_told(BlocksPtr blocks, std::string name, const OpenOptions& options);

}  // namespace e2lf::recordings
