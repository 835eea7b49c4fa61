// SPDX-License-Identifier: MIT
#include "bench/program/moving_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/program/parts.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::bench {
namespace {

using lightfield::LightField;

constexpr int64_t kTurntableKnotUs = 10000;
constexpr size_t kTruthsPerCycle = 8;
constexpr size_t kNearPx = 4;  ///< of what moves

/// Returns the scene at a time, between two of its knots.
Result<LightField> scene_at(const streams::MovingScene& scene, double t_us) {
  if (scene.knot_us == 0) return scene.at(0);
  const double position = t_us / static_cast<double>(scene.knot_us), knot = std::floor(position);
  const auto weight = static_cast<float>(position - knot);
  E2LF_ASSIGN_OR_RETURN(LightField field, scene.at(static_cast<uint64_t>(knot)));
  E2LF_ASSIGN_OR_RETURN(const LightField next, scene.at(static_cast<uint64_t>(knot) + 1));
  for (size_t i = 0; i < field.data().size(); ++i) field.data()[i] += weight * (next.data()[i] - field.data()[i]);
  return field;
}

Result<std::vector<capture::EventImages>> play(const Shot& shot, const capture::Codes& codes,
                                               const capture::SensorProfile& camera, uint64_t seed, size_t cycles) {
  streams::RigOptions options;
  options.schedule = cycles::paper_schedule_of(codes);
  options.trigger_channel.reset();
  const lightfield::Shape& shape = shot.truths.front().shape();
  E2LF_ASSIGN_OR_RETURN(auto rig, streams::VirtualRig::create(codes, camera, streams::camera_stream(camera, seed),
                                                              options, shot.scene, shape.height, shape.width));
  std::vector<capture::EventImages> images;
  for (size_t cycle = 0; cycle < cycles; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(const recordings::EventBatch batch, rig.play_cycle());
    images.push_back(rig.sum_windows(batch));
  }
  return images;
}

Result<capture::EventImages> simulate(const Shot& shot, const capture::Codes& codes,
                                      const capture::SensorProfile& camera, uint64_t seed, size_t cycle) {
  const size_t steps = codes.num_patterns - 1;
  const auto cycle_us = static_cast<double>(cycles::paper_schedule_of(codes).cycle_us());
  sensor::CodedIntensities shown;
  for (size_t n = 0; n <= steps; ++n) {
    const double t_us = cycle_us * (static_cast<double>(cycle) + static_cast<double>(n) / static_cast<double>(steps));
    E2LF_ASSIGN_OR_RETURN(const LightField scene, scene_at(shot.scene, t_us));
    E2LF_ASSIGN_OR_RETURN(const sensor::CodedIntensities all, sensor::coded_intensities(codes, scene));
    if (n == 0) shown.resize(all.count, all.height, all.width);
    std::copy(all.image(n).begin(), all.image(n).end(), shown.image(n).begin());
  }
  sensor::EventModelOptions options{.constants = camera.constants, .seed = seed};
  E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(camera.event_model));
  return sensor::simulate_events(shown, options);
}

/// The place of a square that moves to the right by one pixel per knot.
struct Square {
  size_t top = 0, left = 0, side = 0;

  /// Calls `at(y, x)` for each pixel of a knot and `margin` around it.
  template <typename At>
  void for_each(uint64_t knot, size_t margin, const At& at) const {
    const size_t x = left + static_cast<size_t>(knot);
    for (size_t y = top - margin; y < top + side + margin; ++y) {
      for (size_t dx = 0; dx < side + 2 * margin; ++dx) at(y, x - margin + dx);
    }
  }
};

}  // namespace

Result<Shot> shot_of(streams::MovingScene scene, int64_t cycle_us, size_t cycle) {
  Shot shot{std::move(scene), {}};
  const size_t steps = shot.scene.knot_us > 0 ? kTruthsPerCycle : 0;
  for (size_t n = 0; n <= steps; ++n) {
    const double cycles = static_cast<double>(cycle) + static_cast<double>(n) / kTruthsPerCycle;
    E2LF_ASSIGN_OR_RETURN(shot.truths.emplace_back(), scene_at(shot.scene, cycles * static_cast<double>(cycle_us)));
  }
  return shot;
}

streams::MovingScene shift(const LightField& scene, double px_per_cycle, int64_t cycle_us, size_t cycles, size_t size) {
  const auto needed = static_cast<size_t>(std::ceil(px_per_cycle * static_cast<double>(cycles)));
  const size_t most = std::max(needed, kMostMotionPx);
  streams::MovingScene moving;
  moving.at = [&scene, size, most](uint64_t knot) { return in_view(scene, size, std::min<size_t>(knot, most), most); };
  if (px_per_cycle > 0) moving.knot_us = std::lround(static_cast<double>(cycle_us) / px_per_cycle);
  return moving;
}

streams::MovingScene turn(double rpm, size_t size, uint64_t seed) {
  const double radians = rpm / 60 * 2 * std::numbers::pi * kTurntableKnotUs * 1e-6;
  const auto at = [=](uint64_t knot) -> Result<LightField> {
    const auto angle = static_cast<float>(radians * static_cast<double>(knot));
    return lightfield::render_light_field(lightfield::turntable_scene(angle, seed), {8, 8, size, size, 1});
  };
  return {at, rpm > 0 ? kTurntableKnotUs : 0};
}

Result<Shot> square_before(const LightField& scene, const LightField& thing, size_t px_per_cycle, int64_t cycle_us,
                           size_t cycles, size_t size) {
  E2LF_ASSIGN_OR_RETURN(const LightField still, in_view(scene, size, 0));
  const size_t height = still.shape().height, width = still.shape().width, way = px_per_cycle * cycles;
  const size_t side = std::min(height, width) * 9 / 32;
  if (width < side + way + 2 * (kNearPx + 1) || thing.shape().height < side || thing.shape().width < side) {
    return Error{ErrorCode::kShape, "the scenes have no room for a square that moves; use some of more than 128 px",
                 ""};
  }
  const Square square{(height - side) / 2, (width - side - way) / 2, side};
  E2LF_ASSIGN_OR_RETURN(
      const LightField texture,
      lightfield::crop(thing, {(thing.shape().height - side) / 2, (thing.shape().width - side) / 2, side, side}));
  streams::MovingScene moving;
  moving.knot_us = cycle_us / static_cast<int64_t>(px_per_cycle);
  moving.at = [=](uint64_t knot) -> Result<LightField> {
    LightField field = still;
    const uint64_t last = way;  // later ones are not shown
    const uint64_t now = std::min(knot, last);
    for (size_t v = 0; v < field.shape().views_y; ++v) {
      for (size_t u = 0; u < field.shape().views_x; ++u) {
        square.for_each(now, 0, [&](size_t y, size_t x) {
          field.at(v, u, y, x) = texture.at(4, 4, y - square.top, x - square.left - static_cast<size_t>(now));
        });
      }
    }
    return field;
  };
  E2LF_ASSIGN_OR_RETURN(Shot shot, shot_of(moving, cycle_us, cycles - 1));
  shot.moves.resize(height * width);
  for (size_t knot = px_per_cycle * (cycles - 1); knot <= way; ++knot) {
    square.for_each(knot, kNearPx, [&](size_t y, size_t x) { shot.moves[y * width + x] = 1; });
  }
  return shot;
}

Result<std::vector<capture::EventImages>> record_cycles(const Shot& shot, const capture::Codes& codes,
                                                        const capture::SensorProfile& camera, uint64_t seed,
                                                        size_t cycles) {
  if (camera.is_pixel()) return play(shot, codes, camera, seed, cycles);
  std::vector<capture::EventImages> images;
  for (size_t cycle = 0; cycle < cycles; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(images.emplace_back(), simulate(shot, codes, camera, seed + 1000 * cycle, cycle));
  }
  return images;
}

}  // namespace e2lf::bench
