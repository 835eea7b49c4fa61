// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "e2lf/lightfield/image.h"
#include "e2lf/live/arrival_clock.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::live {

/// The events of a short time as a picture.
struct EventPicture {
  lightfield::ByteImage image;  ///< 128 = no events, brighter = ON, darker = OFF
  uint64_t events = 0;
  double sharpness = 0;  ///< see sharpness_of()
};

/// Returns how steep the edges of a picture of ON minus OFF events [y, x] are, relative to the mean number of events of
/// a pixel: the mean product of the differences between neighbours in adjacent rows (and columns), over the square of
/// that number, at least 0. Edges go on from row to row, whereas the noise of pixels is independent and cancels. Blur
/// of the lens flattens edges, so that the figure is largest in focus; it does not depend on the event rate. 0 without
/// events, and for fewer than 2x2 pixels.
[[nodiscard]] double sharpness_of(const std::vector<int16_t>& signed_counts, size_t width, uint64_t events);

/// Makes pictures of the stream of events for framing and focus, only while someone asks for them: events of kWindowUs
/// are counted, and the next ones only after that picture was taken.
class EventPreview {
 public:
  static constexpr int64_t kWindowUs = 30'000;

  EventPreview(size_t width, size_t height);

  /// Adds what was read; called by the thread that reads.
  void add(const recordings::EventBatch& batch);

  /// Asks for pictures and returns the newest one, or nothing if none is finished yet. The request holds for
  /// kPatience.
  [[nodiscard]] std::optional<EventPicture> take(Clock::time_point now = Clock::now());

  /// Returns true while a request holds.
  [[nodiscard]] bool is_asked(Clock::time_point now = Clock::now()) const;

 private:
  static constexpr std::chrono::seconds kPatience{2};
  void finish();

  size_t width_, height_;
  mutable std::mutex mutex_;
  Clock::time_point asked_{};
  bool is_asked_ = false;
  std::optional<int64_t> begin_us_;
  std::vector<int16_t> signed_;
  std::vector<uint16_t> all_;
  uint64_t events_ = 0;
  std::optional<EventPicture> finished_;
};

}  // namespace e2lf::live
