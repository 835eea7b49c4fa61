// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cycles {

/// How a recording is cut into windows; there is no overlap and, but for triggers, no gap.
enum class WindowKind {
  kTime,      ///< so long each, from the first event or trigger on; the last one may be cut short
  kCount,     ///< so many events each; the last one may have fewer
  kTriggers,  ///< from one trigger to the next; events before the first and after the last are left out
};

struct WindowOptions {
  WindowKind kind = WindowKind::kTime;
  int64_t duration_us = 0;                ///< kTime
  size_t events = 0;                      ///< kCount
  std::optional<int64_t> origin_us = {};  ///< kTime: where the first window begins

  TriggerEdge edge = TriggerEdge::kRising;
  std::optional<uint16_t> channel = {};  ///< of the triggers; nothing = all

  /// More events than this in one window are an error, as are more empty windows in a row: a wrong time would make
  /// them.
  size_t max_events = size_t{1} << 25;
  int64_t max_empty = 100000;

  std::function<void(const recordings::EventBatch&)> on_batch = {};  ///< called with every batch that is read
};

/// Events with begin_us <= t < end_us (kCount: end_us is behind the last one).
struct EventWindow {
  int64_t begin_us = 0, end_us = 0;
  recordings::EventColumns events;
};

/// Cuts a recording into windows, in memory of one window and one batch.
class WindowReader {
 public:
  /// `duration_us` or `events`, whichever the kind needs, is above zero.
  WindowReader(std::unique_ptr<recordings::RecordingReader> reader, WindowOptions options);

  /// Replaces `window` by the next one; false at the end, and when a stop was asked for. Fails as the reader does, and
  /// with kInvalidValue where a window holds too many events or too many in a row hold none.
  [[nodiscard]] Result<bool> next(EventWindow& window);

  [[nodiscard]] uint64_t triggers() const { return triggers_; }              ///< of the channel and edge
  [[nodiscard]] uint64_t events_outside() const { return events_outside_; }  ///< of kTriggers: in no window
  [[nodiscard]] const recordings::RecordingReader& recording() const { return *reader_; }

 private:
  [[nodiscard]] Result<bool> read_batch();
  [[nodiscard]] Result<void> take(size_t end, EventWindow& window);
  [[nodiscard]] Result<bool> next_by_time(EventWindow& window);
  [[nodiscard]] Result<bool> next_by_count(EventWindow& window);
  [[nodiscard]] Result<bool> next_by_triggers(EventWindow& window);
  [[nodiscard]] Result<void> check_gap() const;
  [[nodiscard]] std::optional<int64_t> next_trigger();

  std::unique_ptr<recordings::RecordingReader> reader_;
  WindowOptions options_;
  recordings::EventBatch batch_;
  size_t event_ = 0, trigger_ = 0;   ///< of the batch, not taken yet
  std::optional<int64_t> begin_us_;  ///< of the next window
  bool has_begun_ = false, has_ended_ = false;
  uint64_t triggers_ = 0, events_outside_ = 0;
};

}  // namespace e2lf::cycles
