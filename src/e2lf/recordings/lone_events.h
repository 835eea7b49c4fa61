// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

/// Returns blocks in order of time that warn at their end if times are implausible: if up to nine events at the
/// beginning or the end are apart from all others by more than a hundred times the duration of these, as a single
/// damaged time is, or if a hundred events or more have one time. Of a range of times (`options`), nothing is told.
/// `name` is the location.
[[nodiscard]] std::unique_ptr<EventBlocks> make_lone_events_told(std::unique_ptr<EventBlocks> blocks, std::string name,
                                                                 const OpenOptions& options);

}  // namespace e2lf::recordings
