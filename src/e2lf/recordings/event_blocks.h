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
  /// (make_continued()): the first event of the later part is at after_us + shift_us.
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

/// Whether the events of a format are in order of time. If they may be in any order, events that are sorted by another
/// key (row, column, polarity) are not mistaken for restarts of the clock.
enum class EventOrder { kByTime, kAny };

/// Makes times continuous across restarts of the clock: the times of each later part are shifted so that
/// they follow those of the previous part. EventBlocks::restarts() returns the positions and the shifts. A decrease is
/// a restart if the times before it increase and are later, and the times after it continue from it. Events are delayed
/// until at most kRestartWitnesses later ones are known, and each call of next() reads one block or returns false.
/// Triggers belong to the later part if they follow a decrease of their own times, or a block with a restart.
[[nodiscard]] BlocksPtr make_continued(BlocksPtr blocks, EventOrder order);

struct TimeSortOptions {
  size_t memory_events = size_t{1} << 22;  ///< maximum number sorted in memory (13 bytes each); more use a file
  size_t pipe_events = size_t{1} << 16;    ///< number of events that are buffered if the source is not seekable
};

/// Sorts blocks by time; events with equal times keep their order. Events that are out of order are counted
/// (DecodeSummary::out_of_order), and none is dropped. Times continue across restarts of the clock (make_continued()),
/// and parts are not mixed.
/// A seekable source is first read once to check its order. If it is not in order and contains more than memory_events,
/// it is sorted with a temporary file (SortedRuns). Other sources are sorted while they are read, and next() fails with
/// kUnsupported if an event is more than pipe_events too late. `name` is the location in errors.
[[nodiscard]] BlocksPtr make_time_sorted(BlocksPtr blocks, bool is_seekable, std::string name,
                                         const TimeSortOptions& options = {});

}  // namespace e2lf::recordings
