// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::streams {

using cycles::ShownPattern;

/// Computes the light that reaches each pixel through the pattern on the aperture: through the open cells, with the
/// transmission that the camera states for each place, and the leak through the closed ones; and through an inverse,
/// the light of the open aperture minus that of the pattern, as in sensor::simulate_pixel_events().
class ShownLight {
 public:
  ShownLight(const capture::Codes& codes, const capture::SensorProfile& camera, float gain, size_t height,
             size_t width);

  /// Returns the patterns, followed by the open aperture.
  [[nodiscard]] const capture::Codes& codes() const { return codes_; }

  /// Computes the image [y, x] through one pattern. `intensities` are those of codes() for a scene.
  void image(const capture::CodedIntensities& intensities, ShownPattern shown, std::vector<float>& light) const;

  /// Returns true if all cells are closed.
  [[nodiscard]] bool is_black(ShownPattern shown) const;

 private:
  capture::Codes codes_;
  std::vector<std::vector<float>> transmission_;  ///< one map [y, x] for each of a2, a3, ...
  float gain_, leak_;
};

/// The scene in front of the camera.
struct MovingScene {
  /// Returns the light field of knot 0, 1, ... It is called once for each, in this order.
  std::function<Result<lightfield::LightField>(uint64_t knot)> at;
  int64_t knot_us = 0;  ///< interval of knots, between which light changes linearly; 0 = knot 0 is static
};

struct RigOptions {
  cycles::Schedule schedule = cycles::paper_schedule();
  float gain = 1.0F;          ///< scene brightness, which multiplies every intensity
  int64_t rise_us = 0;        ///< rise time of the display: light changes linearly from pattern to pattern
  int64_t begin_us = 100000;  ///< time of the first cycle and of knot 0
  std::optional<uint16_t> trigger_channel =
      0;                           ///< channel of the rising edge at the start of each pattern; absent = no triggers
  int64_t trigger_width_us = 500;  ///< time until the falling edge; 0 = no such edge
};

/// A display behind a lens and an event camera, in software. It shows the patterns of a schedule repeatedly and returns
/// the events and triggers of each cycle. The state of the pixels is carried from cycle to cycle.
class VirtualRig {
 public:
  /// Creates the rig. `codes` are a1 to aN, or capture::whole_cycle() of them. `camera` provides transmission and leak,
  /// and `stream` everything else. Fails as shown_patterns() and EventStream::create() do, and with kInvalidValue (a
  /// rise that is longer than a pattern, or a negative time).
  [[nodiscard]] static Result<VirtualRig> create(const capture::Codes& codes, const capture::SensorProfile& camera,
                                                 const StreamOptions& stream, const RigOptions& options,
                                                 MovingScene scene, size_t height, size_t width);

  /// Returns the events and triggers of the next cycle; the first call also returns those of the patterns before
  /// schedule.first_of_cycle(). Events that a readout limit delays beyond its end are returned with the next cycle.
  /// Fails as the scene does, and with kShape if its size changes.
  [[nodiscard]] Result<recordings::EventBatch> play_cycle();

  /// Returns the event images of the last cycle that was played, summed from its events.
  [[nodiscard]] capture::EventImages sum_windows(const recordings::EventBatch& batch) const;

  [[nodiscard]] uint64_t lost_events() const { return stream_.lost_events(); }

 private:
  VirtualRig(const capture::Codes& codes, const capture::SensorProfile& camera, EventStream stream,
             const RigOptions& options, MovingScene scene, size_t height, size_t width);
  [[nodiscard]] Result<void> show(ShownPattern shown, int64_t end_us, recordings::EventColumns& events);
  [[nodiscard]] Result<void> rest_before(ShownPattern first);
  [[nodiscard]] Result<void> reach_knot(int64_t t_us);
  [[nodiscard]] int64_t next_stop(int64_t pattern_begin_us, int64_t end_us) const;
  [[nodiscard]] bool is_rising(int64_t pattern_begin_us) const { return now_us_ < pattern_begin_us + options_.rise_us; }
  void light_at(int64_t t_us, ShownPattern shown, std::vector<float>& light);
  void light_of_rise(int64_t t_us, int64_t pattern_begin_us, ShownPattern shown, std::vector<float>& light);

  RigOptions options_;
  std::vector<ShownPattern> shown_;
  ShownLight aperture_;
  EventStream stream_;
  MovingScene scene_;
  size_t height_, width_;

  int64_t now_us_;
  int64_t cycle_begin_us_;                 ///< start of the cycle played last
  uint64_t pattern_ = 0;                   ///< counted from the first
  std::optional<ShownPattern> before_;     ///< shown before this pattern
  uint64_t num_knots_ = 0;                 ///< requested so far
  capture::CodedIntensities knot_, next_;  ///< coded intensities of the last two knots
  std::vector<float> from_, to_, other_;
  recordings::EventColumns late_;  ///< delayed events, returned with the next cycle
};

}  // namespace e2lf::streams
