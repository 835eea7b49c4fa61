// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>
#include <string>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/trigger_feed.h"

namespace e2lf::recordings {

/// A source that delivers events in blocks of its own choice; the interface that container formats implement.
class EventBlocks {
 public:
  virtual ~EventBlocks() = default;

  /// Replaces `block` by the next one, which may be empty. Returns false at the end. Events may be implausible, and
  /// triggers may be delivered before or after the events of their time; a trigger before its predecessor is dropped.
  [[nodiscard]] virtual Result<bool> next(EventBatch& block, DecodeSummary& summary) = 0;

  /// Returns the position in the file of the block of the last next(); 0 = unknown.
  [[nodiscard]] virtual uint64_t block_byte() const { return 0; }

  /// Returns the size of an event in the file, in bytes; 0 = not constant.
  [[nodiscard]] virtual size_t event_bytes() const { return 0; }

  /// Returns the restarts of the clock in the blocks since the start or the last seek, whose times were made continuous
  /// (continued_clock.h): the first event of the later part is at after_us + shift_us.
  [[nodiscard]] virtual std::span<const Restart> restarts() const { return {}; }

  /// Seeks to a block that begins before t_us, as close as is possible at low cost, or to the first block. Fails with
  /// kUnsupported and kIo.
  [[nodiscard]] virtual Result<void> seek_before(int64_t t_us) = 0;
};

using BlocksPtr = std::unique_ptr<EventBlocks>;

/// Creates a reader of blocks. It divides them into the requested batches, drops implausible events (EventGate), begins
/// a part at each of restarts(), and delivers triggers with the events of their time; these come from the blocks or, if
/// they are stored separately, from `triggers`.
[[nodiscard]] ReaderPtr make_block_reader(BlocksPtr blocks, RecordingInfo info, const std::string& name,
                                          const OpenOptions& options, TriggerFeed triggers = {});

}  // namespace e2lf::recordings
