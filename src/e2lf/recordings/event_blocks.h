// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// A source that delivers events in blocks of its own choice, as they are stored; the interface that formats implement.
/// It only decodes: Timeline decides about order, damaged times and restarts of the clock, for all formats alike.
class EventBlocks {
 public:
  virtual ~EventBlocks() = default;

  /// Replaces `block` by the next one, which may be empty. Returns false at the end. Events may be implausible, and
  /// triggers may be delivered before or after the events of their time.
  [[nodiscard]] virtual Result<bool> next(EventBatch& block, DecodeSummary& summary) = 0;

  /// Returns the position in the file of the block of the last next(); 0 = unknown.
  [[nodiscard]] virtual uint64_t block_byte() const { return 0; }

  /// Returns the size of an event in the file, in bytes; 0 = not constant.
  [[nodiscard]] virtual size_t event_bytes() const { return 0; }

  /// Returns whether the block of the last next() begins another recording at block_byte(), after a header or where the
  /// decoder found that the clock was reset. Its clock may have started again.
  [[nodiscard]] virtual bool begins_recording() const { return false; }

  /// Returns whether the decoder itself delivers plausible events and triggers in order of time, as that of RAW words
  /// does. They are then passed on without further checks.
  [[nodiscard]] virtual bool is_ordered() const { return false; }

  /// Limits the number of events of the following blocks, if blocks of this size are as cheap as others.
  virtual void limit_block(size_t /*max_events*/) {}

  /// RecordingReader::skip_events() in the times of next(). The default leaves out nothing.
  virtual void skip_events(int64_t /*begin_us*/, int64_t /*end_us*/) {}

  /// RecordingReader::arrival().
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> arrival() const { return std::nullopt; }

  /// Seeks to a block that begins before t_us, as close as is possible at low cost, or to the first block. Fails with
  /// kUnsupported and kIo.
  [[nodiscard]] virtual Result<void> seek_before(int64_t t_us) = 0;
};

using BlocksPtr = std::unique_ptr<EventBlocks>;

/// A source of triggers that are stored separately from the events (in a second file or data set), in order of time.
class TriggerSource {
 public:
  virtual ~TriggerSource() = default;

  /// Appends the next triggers to `block` and counts those that cannot be read. Returns false at the end.
  [[nodiscard]] virtual Result<bool> next(std::vector<Trigger>& block, DecodeSummary& summary) = 0;

  /// Returns to the first trigger.
  [[nodiscard]] virtual Result<void> rewind() = 0;
};

using TriggersPtr = std::unique_ptr<TriggerSource>;

class RecordingReader;
struct RecordingInfo;
struct OpenOptions;

/// Creates a reader of blocks, and of triggers that are stored separately, if there are any. Null blocks contain no
/// events. `name` is the location in messages.
[[nodiscard]] std::unique_ptr<RecordingReader> make_block_reader(BlocksPtr blocks, RecordingInfo info,
                                                                 const std::string& name, const OpenOptions& options,
                                                                 TriggersPtr triggers = {});

}  // namespace e2lf::recordings
