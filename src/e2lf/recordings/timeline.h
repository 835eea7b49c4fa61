// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

/// Puts the events and triggers of a recording into order of time. It is the only place that decides about times:
///   - An event that is at most kDisorderUs (10 ms) earlier than the latest one before it is sorted to its place
///     (DecodeSummary::out_of_order).
///   - An event that is still earlier is dropped (kTimeBackwards), as is one that is later by more than this than most
///     of its next kTimeLookAhead successors (kTimeJump), or outside the sensor (kOutOfRange). A flipped bit therefore
///     removes one event and not all that follow. If a quarter of the events is too early, the recording is refused.
///   - The clock starts again where times decrease by more than kDisorderUs and most of the next kRestartWitnesses
///     times continue from there, unless these events are sorted by row, column or polarity; or at a header of another
///     recording. Parts are not mixed.
///   - A trigger that is at most kDisorderUs earlier than its predecessor takes the time of that one, and an earlier
///     one is dropped. Triggers belong to the later part if they follow a decrease of their own times, or a block with
///     a restart.
/// Events wait until later ones can no longer precede them. Events in order are neither copied nor inspected one by
/// one.
class Timeline {
 public:
  /// `blocks` may be null. `width` and `height` are the size of the sensor in px, 0 = unlimited; `name` is the location
  /// in errors.
  Timeline(BlocksPtr blocks, BlocksPtr triggers, size_t width, size_t height, std::string name);

  [[nodiscard]] EventBlocks* blocks() const { return blocks_.get(); }

  /// Replaces `batch` by the next events and triggers of one part, which may be none. Returns false at the end. Fails
  /// as the blocks do, and with kFormat if a quarter of the events is out of order by more than kDisorderUs.
  [[nodiscard]] Result<bool> next(EventBatch& batch, DecodeSummary& summary);

  /// Returns the place before what next() returned, if another part begins there: its byte, and the last time of the
  /// part before it. Returns it once.
  [[nodiscard]] std::optional<Restart> take_restart() { return std::exchange(restart_, std::nullopt); }

  /// Seeks to a position before t_us on the clock of the first part.
  [[nodiscard]] Result<void> seek_before(int64_t t_us);

 private:
  /// Events in order of time, all of one part.
  struct Section {
    EventColumns events;
    size_t part = 0;
  };
  struct WaitingTrigger {
    Trigger trigger;
    size_t part = 0;        ///< number of restarts that were known when it was read
    uint64_t position = 0;  ///< number of events that were read before
  };

  [[nodiscard]] Result<bool> pass_on(EventBatch& batch, DecodeSummary& summary);
  void hand_out(EventBatch& batch);
  void begin_later_part();
  [[nodiscard]] bool is_complete(const Section& section) const;

  [[nodiscard]] Result<void> read_block(DecodeSummary& summary);
  [[nodiscard]] bool continues(const EventColumns& events) const;
  void add_in_order(EventColumns& events);
  void reopen();
  void add_unordered(const EventColumns& events, DecodeSummary& summary);
  [[nodiscard]] Result<void> judge(bool is_end, DecodeSummary& summary);
  [[nodiscard]] std::optional<Violation> fault(size_t i) const;
  void add_judged();
  [[nodiscard]] bool starts_again(size_t begin, size_t i) const;
  [[nodiscard]] std::vector<int64_t> times_before(size_t begin, size_t i) const;
  void end_part(uint64_t byte);
  [[nodiscard]] uint64_t byte_of(size_t i) const;
  [[nodiscard]] Result<void> refuse_disorder(bool is_end) const;

  [[nodiscard]] Result<void> take_triggers(int64_t until_us, EventBatch& batch, DecodeSummary& summary);
  [[nodiscard]] Result<void> refill_triggers(DecodeSummary& summary);
  [[nodiscard]] bool fall_may_be_restart() const;
  [[nodiscard]] bool is_trigger_ahead() const;

  BlocksPtr blocks_;
  size_t width_, height_;
  std::string name_;

  // What was read.
  EventBatch block_;
  uint64_t num_read_ = 0;                   ///< number of events
  bool has_ended_ = false;                  ///< whether all blocks were read
  std::deque<Section> sections_;            ///< events that wait, in order
  std::vector<EventColumns> spare_;         ///< memory of sections that were returned
  size_t num_waiting_ = 0;                  ///< number of events in sections_
  size_t num_open_ = 0;                     ///< number of events at the end of sections_ that are not judged yet
  EventColumns unjudged_;                   ///< the last events that were read, if they are not in order
  EventColumns judged_;                     ///< those of them that are plausible
  std::vector<int64_t> recent_us_;          ///< the last times of the part before unjudged_, in the order of the file
  int64_t latest_us_ = INT64_MIN;           ///< latest time of the judged events of the part
  int64_t newest_us_ = INT64_MIN;           ///< latest time of all events of the part in sections_
  int64_t floor_us_ = INT64_MIN;            ///< last time of the part that was returned
  bool has_on_ = false, has_off_ = false;   ///< whether the part has such events
  uint64_t num_judged_ = 0, num_late_ = 0;  ///< number of events, and of those that were too early
  std::vector<uint64_t> part_bytes_;        ///< where each later part begins in the file

  // What was returned.
  size_t part_ = 0;              ///< number of restarts before the next events
  int64_t last_us_ = INT64_MIN;  ///< latest time of the part
  std::optional<Restart> restart_;

  // Triggers.
  BlocksPtr source_;
  EventBatch from_source_;
  bool has_more_triggers_ = false;  ///< in source_
  std::deque<WaitingTrigger> triggers_;
  size_t trigger_part_ = 0;
  int64_t last_trigger_us_ = INT64_MIN;  ///< last trigger of the part that was returned
};

}  // namespace e2lf::recordings
