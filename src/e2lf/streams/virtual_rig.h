// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/streams/event_stream.h"
#include "e2lf/streams/shown_light.h"

namespace e2lf::streams {

/// The scene before the camera.
struct MovingScene {
  /// The light field of knot 0, 1, ...; asked for once each, in this order.
  std::function<Result<lightfield::LightField>(uint64_t knot)> at;
  int64_t knot_us = 0;  ///< from knot to knot; between them light changes linearly. 0 = knot 0 stands still
};

struct RigOptions {
  cycles::Schedule schedule = cycles::paper_schedule();
  float gain = 1.0F;          ///< scene brightness: multiplies every intensity
  int64_t rise_us = 0;        ///< of the display: light goes over from pattern to pattern in a straight line
  int64_t begin_us = 100000;  ///< of the first cycle, and of knot 0
  std::optional<uint16_t> trigger_channel = 0;  ///< a rising edge at the start of each pattern; nothing = no triggers
  int64_t trigger_width_us = 500;               ///< to the falling edge; 0 = none
};

/// A display behind a lens and an event camera, made of numbers: shows the patterns of a schedule again and again, and
/// gives the events and triggers of each cycle. Pixels remember everything from cycle to cycle.
class VirtualRig {
 public:
  /// Fails as shown_patterns(), EventStream::create() and with kInvalidValue (a rise that is longer than a pattern, a
  /// time that is negative). `codes` are a1 to aN, or capture::whole_cycle() of them. The camera gives transmission and
  /// leak; `stream` everything else.
  [[nodiscard]] static Result<VirtualRig> create(const capture::Codes& codes, const capture::Camera& camera,
                                                 const StreamOptions& stream, const RigOptions& options,
                                                 MovingScene scene, size_t height, size_t width);

  /// The events and triggers of the next cycle; before the first, those of the patterns before
  /// schedule.first_of_cycle(). Events that a readout limit holds back beyond its end come with the
  /// next. Fails as the scene does, and with kShape when it changes its size.
  [[nodiscard]] Result<recordings::EventBatch> play_cycle();

  /// The event images of the cycle that was played last, summed from its events.
  [[nodiscard]] capture::EventImages sum_windows(const recordings::EventBatch& batch) const;

  [[nodiscard]] uint64_t lost_events() const { return stream_.lost_events(); }

 private:
  VirtualRig(const capture::Codes& codes, const capture::Camera& camera, EventStream stream, const RigOptions& options,
             MovingScene scene, size_t height, size_t width);
  [[nodiscard]] Result<void> show(ShownPattern shown, int64_t end_us, recordings::EventColumns& events);
  [[nodiscard]] Result<void> rest_before(ShownPattern first);
  [[nodiscard]] Result<void> reach_knot(int64_t t_us);
  [[nodiscard]] int64_t next_stop(int64_t pattern_begin_us, int64_t end_us) const;
  [[nodiscard]] bool is_rising(int64_t pattern_begin_us) const;
  void light_at(int64_t t_us, ShownPattern shown, std::vector<float>& light);
  void light_of_rise(int64_t t_us, int64_t pattern_begin_us, ShownPattern shown, std::vector<float>& light);
  void add_trigger(recordings::EventBatch& batch) const;

  RigOptions options_;
  std::vector<ShownPattern> shown_;
  ShownLight aperture_;
  EventStream stream_;
  MovingScene scene_;
  size_t height_, width_;

  int64_t now_us_;
  int64_t cycle_begin_us_;                 ///< of the cycle that was played last
  uint64_t pattern_ = 0;                   ///< counted from the first
  std::optional<ShownPattern> before_;     ///< what was shown before this pattern
  uint64_t num_knots_ = 0;                 ///< that were asked for
  capture::CodedIntensities knot_, next_;  ///< of the last two of them
  std::vector<float> from_, to_, other_;
  recordings::EventColumns late_;  ///< events of the cycles before that come in the next
};

}  // namespace e2lf::streams
