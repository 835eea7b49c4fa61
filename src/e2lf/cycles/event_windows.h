// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cycles {

/// The ways of dividing a recording into windows. They do not overlap and, except for triggers, have no gaps.
enum class WindowKind {
  kTime,      ///< windows of equal duration, from the first event or trigger on; the last one may be shorter
  kCount,     ///< windows of equal numbers of events; the last one may have fewer
  kTriggers,  ///< windows from one trigger to the next; events before the first and after the last are left out
};

struct WindowOptions {
  WindowKind kind = WindowKind::kTime;
  int64_t duration_us = 0;                ///< kTime
  size_t events = 0;                      ///< kCount
  std::optional<int64_t> origin_us = {};  ///< kTime: the beginning of the first window

  TriggerEdge edge = TriggerEdge::kRising;
  std::optional<uint16_t> channel = {};  ///< channel of the triggers; absent = all channels

  /// The limits for the number of events in a window and of consecutive empty windows, which a wrong time would exceed.
  /// Exceeding them is an error.
  size_t max_events = size_t{1} << 25;
  int64_t max_empty = 100000;

  std::function<void(const recordings::EventBatch&)> on_batch = {};  ///< called with every batch that is read
};

/// The events with begin_us <= t < end_us (kCount: end_us is after the last one).
struct EventWindow {
  int64_t begin_us = 0, end_us = 0;
  recordings::EventColumns events;
};

/// Divides a recording into windows, with memory for one window and one batch.
class WindowReader {
 public:
  /// `duration_us` or `events`, whichever the kind needs, must be positive.
  WindowReader(std::unique_ptr<recordings::RecordingReader> reader, WindowOptions options);

  /// Replaces `window` by the next one. Returns false at the end and if a stop was requested. Fails as the reader does,
  /// and with kInvalidValue if a window has too many events or too many consecutive windows are empty.
  [[nodiscard]] Result<bool> next(EventWindow& window);

  [[nodiscard]] uint64_t triggers() const { return triggers_; }  ///< number of triggers of the channel and edge
  [[nodiscard]] uint64_t events_outside() const { return events_outside_; }  ///< kTriggers: in no window
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
  size_t event_ = 0, trigger_ = 0;   ///< in the batch, not yet taken
  std::optional<int64_t> begin_us_;  ///< start of the next window
  bool has_begun_ = false, has_ended_ = false;
  uint64_t triggers_ = 0, events_outside_ = 0;
};

/// Distributes events over the bins of a voxel grid as in E2VID (Rebecq et al., TPAMI 2021, Eq. 1) and EVREAL: an event
/// of sign p (+1 ON, -1 OFF) at time t adds p max(0, 1 - |t* - b|) to bin b of its pixel, where t* = (t - t_first) /
/// (t_last - t_first) (bins - 1). If all events have the same time, they are distributed evenly over the bins in their
/// order. The events must be sorted by time and lie within the image, or the contract is broken.
[[nodiscard]] capture::VoxelGrid voxelise(const recordings::EventColumns& events, size_t bins, size_t height,
                                          size_t width);

/// Returns the sum of the signed events of each pixel, [y, x], i.e. the grid with one bin.
[[nodiscard]] std::vector<float> signed_counts(const recordings::EventColumns& events, size_t height, size_t width);

}  // namespace e2lf::cycles
