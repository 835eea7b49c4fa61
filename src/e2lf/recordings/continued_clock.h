// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

/// Whether the events of a format are in order of time. If they may be in any order, events that are sorted by another
/// key (row, column, polarity) are not mistaken for restarts of the clock.
enum class EventOrder { kByTime, kAny };

/// Makes times continuous across restarts of the clock (restart.h): the times of each later part are shifted so that
/// they follow those of the previous part. EventBlocks::restarts() returns the positions and the shifts. A decrease is
/// a restart if the times before it increase and are later, and the times after it continue from it. Events are delayed
/// until at most kRestartWitnesses later ones are known, and each call of next() reads one block or returns false.
/// Triggers belong to the later part if they follow a decrease of their own times, or a block with a restart.
[[nodiscard]] BlocksPtr make_continued(BlocksPtr blocks, EventOrder order);

}  // namespace e2lf::recordings
