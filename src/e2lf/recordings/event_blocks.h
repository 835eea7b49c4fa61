// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>
#include <string>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/trigger_feed.h"

namespace e2lf::recordings {

/// A source of events in blocks of a size it chooses: what a container format implements.
class EventBlocks {
 public:
  virtual ~EventBlocks() = default;

  /// Replaces `block` by the next one, maybe empty; false at the end. Events need not be believable yet, and triggers
  /// may come before or after the events of their time; one earlier than the trigger before it is dropped.
  [[nodiscard]] virtual Result<bool> next(EventBatch& block, DecodeSummary& summary) = 0;

  /// Where in the file the block of the last next() begins; 0 = not known.
  [[nodiscard]] virtual uint64_t block_byte() const { return 0; }

  /// How many bytes an event takes there; 0 = they differ.
  [[nodiscard]] virtual size_t event_bytes() const { return 0; }

  /// The restarts of the clock among what next() has read since the start or the last seek, whose times go on
  /// (continued_clock.h): the first event of the later part is at after_us + shift_us.
  [[nodiscard]] virtual std::span<const Restart> restarts() const { return {}; }

  /// Goes to a block that begins before t_us, as near as is cheap, or to the first. Fails with kUnsupported and kIo.
  [[nodiscard]] virtual Result<void> seek_before(int64_t t_us) = 0;
};

/// A reader over blocks: cuts them to the batches asked for, drops unbelievable events (EventGate), begins a part at
/// each of restarts(), and hands triggers out beside the events of their time; they come from the blocks or, where they
/// lie apart, from `triggers`.
[[nodiscard]] std::unique_ptr<RecordingReader> make_block_reader(std::unique_ptr<EventBlocks> blocks,
                                                                 RecordingInfo info, const std::string& name,
                                                                 const OpenOptions& options, TriggerFeed triggers = {});

}  // namespace e2lf::recordings
