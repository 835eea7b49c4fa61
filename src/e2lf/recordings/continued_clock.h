// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

/// Whether a format promises events in the order of time. Where it does not, events that are sorted by something else
/// (row, column, polarity) look as if the clock started again and again.
enum class EventOrder { kByTime, kAny };

/// Returns `blocks` with the times of each part behind a restart of the clock (restart.h) moved behind those of the
/// part in front of it, so that all times go on; EventBlocks::restarts() says where and by how much. A fall is a
/// restart if the times in front of it rise and are later, and those behind it go on from it. Events wait for at most
/// kRestartWitnesses later ones, and each call of next() reads a block or ends. Triggers of a later part are known by
/// their own fall, or by standing in a block behind it.
[[nodiscard]] std::unique_ptr<EventBlocks> make_continued(std::unique_ptr<EventBlocks> blocks, EventOrder order);

}  // namespace e2lf::recordings
