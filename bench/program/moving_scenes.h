// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/streams/virtual_rig.h"

/// Scenes that move while cycles are recorded, for `e2lf-bench motion`.
namespace e2lf::bench {

/// A scene in motion, and the views of it that one of its cycles may show.
struct Shot {
  streams::MovingScene scene;
  std::vector<lightfield::LightField> truths;
  /// 1 for the pixels [y, x] that something passes during this cycle, or near it; empty if no part moves alone.
  std::vector<uint8_t> moves = {};
};

/// Returns a scene with its views at equal distances of time in a cycle, which is numbered from 0.
[[nodiscard]] Result<Shot> shot_of(streams::MovingScene scene, int64_t cycle_us, size_t cycle);

/// Returns a scene, at most size x size px, that moves to the left by `px_per_cycle` for `cycles` cycles.
[[nodiscard]] streams::MovingScene shift(const lightfield::LightField& scene, double px_per_cycle, int64_t cycle_us,
                                         size_t cycles, size_t size);

/// Returns the still life on the turntable.
[[nodiscard]] streams::MovingScene turn(double rpm, size_t size, uint64_t seed);

/// Returns the last of `cycles` cycles in which a square moves to the right by `px_per_cycle` before a scene that
/// stands still. The square, 9/32 of the height, is the middle of a view of `thing`, at the disparity 0.
[[nodiscard]] Result<Shot> square_before(const lightfield::LightField& scene, const lightfield::LightField& thing,
                                         size_t px_per_cycle, int64_t cycle_us, size_t cycles, size_t size);

/// Records the event images of whole cycles from 0 on, of which the first one only prepares the references. Physical
/// pixels see the motion within a cycle. In the event models of the paper, a pattern is shown at one moment, which is
/// the light that its events lead to. `seed` determines the noise.
[[nodiscard]] Result<std::vector<capture::EventImages>> record_cycles(const Shot& shot, const capture::Codes& codes,
                                                                      const capture::SensorProfile& camera,
                                                                      uint64_t seed, size_t cycles);

}  // namespace e2lf::bench
