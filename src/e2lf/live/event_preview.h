// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/live/live_cycle.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::live {

/// The sharpness of all event images of a cycle. Unlike that of a picture, which shows the patterns of its moment, it
/// is the same for each cycle of a still scene, but for noise.
struct CycleSharpness {
  uint64_t number = 0;  ///< of the cycle in the recording
  double sharpness = 0;
};

/// A picture of the events of a short time window.
struct EventPicture {
  lightfield::ByteImage image;  ///< 128 = no events, brighter = ON, darker = OFF
  uint64_t events = 0;
  double sharpness = 0;                      ///< see sharpness_of()
  std::optional<CycleSharpness> cycle = {};  ///< of the newest cycle; empty until there is one
};

/// Computes how sharp the edges are in a picture [y, x] of the number of ON minus OFF events per pixel: the mean
/// product of the differences between neighbours in adjacent rows (and columns), divided by the square of the mean
/// number of events per pixel, and at least 0. Edges extend over several rows, whereas the noise of the pixels is
/// independent and cancels. Defocus flattens edges, so that the value is largest in focus; it does not depend on the
/// event rate. Returns 0 if there are no events or fewer than 2x2 pixels.
[[nodiscard]] double sharpness_of(std::span<const int16_t> signed_counts, size_t width, uint64_t events);

/// Returns the mean over the event images of a cycle, weighted by the squares of their numbers of events.
[[nodiscard]] double sharpness_of(const capture::EventImages& images);

/// Makes pictures of the event stream for framing and focusing, but only while pictures are requested. Each picture
/// accumulates the events of kWindowUs; the next picture starts after the previous one was taken.
class EventPreview {
 public:
  static constexpr int64_t kWindowUs = 30'000;

  EventPreview(size_t width, size_t height) : width_(width), height_(height) {}

  /// Adds a batch of events. Called by the reading thread.
  void add(const recordings::EventBatch& batch);

  /// Passes the newest cycle on. Called by the reading thread.
  void add_cycle(uint64_t number, const capture::EventImages& images);

  /// Requests pictures and returns the newest one, or nothing if none is complete yet. A request is valid for
  /// kPatience.
  [[nodiscard]] std::optional<EventPicture> take(Clock::time_point now = Clock::now());

  /// Returns true while a request is valid.
  [[nodiscard]] bool is_asked(Clock::time_point now = Clock::now()) const;

 private:
  static constexpr std::chrono::seconds kPatience{2};
  void finish();

  size_t width_, height_;
  mutable std::mutex mutex_;
  std::optional<Clock::time_point> asked_;
  std::optional<int64_t> begin_us_;
  std::vector<int16_t> signed_;
  std::vector<uint16_t> all_;
  uint64_t events_ = 0;
  std::optional<EventPicture> finished_;
  std::optional<CycleSharpness> cycle_;
};

}  // namespace e2lf::live
