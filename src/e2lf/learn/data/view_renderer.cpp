// SPDX-License-Identifier: MIT
// Implements render_view() of synthesiser.h.
#include <algorithm>
#include <array>
#include <vector>

#include "e2lf/learn/data/synthesiser.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/learn/data/view_renderer.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef E2LF_LEARN_VIEW_RENDERER_ONCE
#define E2LF_LEARN_VIEW_RENDERER_ONCE
namespace e2lf::learn {

constexpr uint32_t kSteps = 1024;       // number of distinct positions between two pixels
constexpr float kHidden = 1.0F / 1024;  // share of light from behind that is below a grey level
constexpr size_t kTaps = 8;             // four neighbours of two interleaved maps

/// Returns the weights of four neighbours for a position `t` in [0, 1] after the second: Keys' cubic with a = -0.75, as
/// in torch.
inline std::array<float, 4> cubic_weights(float t) {
  constexpr float a = -0.75F;
  const auto near = [](float x) { return ((a + 2.0F) * x - (a + 3.0F)) * x * x + 1.0F; };
  const auto far = [](float x) { return ((a * x - 5.0F * a) * x + 8.0F * a) * x - 4.0F * a; };
  return {far(t + 1.0F), near(t), near(1.0F - t), far(2.0F - t)};
}

/// The weights of every distinct position, each twice, for both maps.
struct alignas(64) WeightTable {
  float at[kSteps][kTaps];

  WeightTable() {
    for (uint32_t step = 0; step < kSteps; ++step) {
      const auto weights = cubic_weights(static_cast<float>(step) / kSteps);
      for (size_t i = 0; i < kTaps; ++i) at[step][i] = weights[i / 2];
    }
  }
};

/// The rays of one row of a view: positions in the maps of a plane at equal steps.
struct RowOfRays {
  float y, x, step_y, step_x;
};

inline RowOfRays row_of_rays(const Plane& plane, const ViewPoint& from, size_t row, size_t size, size_t side) {
  const double corner = -0.5 * static_cast<double>(size - 1), first = corner - plane.offset_x;
  const double y = static_cast<double>(row) + corner - plane.offset_y;
  const double middle = 0.5 * static_cast<double>(side - 1);
  const double shrink = 1.0 / (1.0 + plane.slope_y * from.y + plane.slope_x * from.x);
  const double disparity = (plane.centre + plane.slope_y * y + plane.slope_x * first) * shrink;
  const double step = plane.slope_x * shrink;
  return {static_cast<float>(y - from.y * disparity + middle), static_cast<float>(first - from.x * disparity + middle),
          static_cast<float>(-from.y * step), static_cast<float>(1.0 - from.x * step)};
}

/// A position in the maps, px.
struct Position {
  float y, x;
};

/// Returns the relief at a position, linearly and with edges repeated.
inline float relief_at(const float* relief, size_t side, const Position& at) {
  const float last = static_cast<float>(side) - 1.001F;
  const float y = std::clamp(at.y, 0.0F, last), x = std::clamp(at.x, 0.0F, last);
  const auto row = static_cast<uint32_t>(y), column = static_cast<uint32_t>(x);
  const float below = y - static_cast<float>(row), right = x - static_cast<float>(column);
  const float* p = relief + row * side + column;
  return (1 - below) * ((1 - right) * p[0] + right * p[1]) + below * ((1 - right) * p[side] + right * p[side + 1]);
}

/// Returns where a ray meets a relief, from where it meets the plane.
inline Position meet_relief(const float* relief, size_t side, const ViewPoint& from, const Position& on_plane) {
  const auto view_y = static_cast<float>(from.y), view_x = static_cast<float>(from.x);
  Position at = on_plane;
  for (int step = 0; step < kReliefSteps; ++step) {
    const float deviation = relief_at(relief, side, at);
    at = {on_plane.y - view_y * deviation, on_plane.x - view_x * deviation};
  }
  return at;
}

struct Sample {
  float brightness, coverage;
};

}  // namespace e2lf::learn
#endif

HWY_BEFORE_NAMESPACE();
namespace e2lf::learn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Converts a position to steps of 1 / kSteps px from one px before the map, where its border has begun.
HWY_INLINE uint32_t in_steps(float position, float side) {
  return static_cast<uint32_t>((std::clamp(position, -1.0F, side) + 1.0F) * kSteps + 0.5F);
}

/// Returns whether a ray that meets the plane at a position may be covered.
HWY_INLINE bool may_cover(const MappedPlane& plane, size_t side, const Position& at) {
  if (plane.may_cover == nullptr) return true;
  const auto last = static_cast<float>(side);
  const size_t row = in_steps(at.y, last) / kSteps + 1, column = in_steps(at.x, last) / kSteps + 1;
  return plane.may_cover[row * (side + kMapBorder) + column] != 0;
}

HWY_INLINE Sample sample(const float* maps, size_t side, const WeightTable& table, float y, float x) {
  const hn::CappedTag<float, kTaps> d;
  const uint32_t from_top = in_steps(y, static_cast<float>(side)), from_left = in_steps(x, static_cast<float>(side));
  const float *weights_y = table.at[from_top % kSteps], *weights_x = table.at[from_left % kSteps];
  const size_t stride = 2 * (side + 2 * kMapBorder);
  const float* first = maps + (from_top / kSteps + kMapBorder - 2) * stride + 2 * (from_left / kSteps + kMapBorder - 2);
  alignas(64) float sums[kTaps];
  for (size_t i = 0; i < kTaps; i += hn::Lanes(d)) {
    const float* tap = first + i;
    auto column = hn::Mul(hn::Set(d, weights_y[0]), hn::LoadU(d, tap));
    column = hn::MulAdd(hn::Set(d, weights_y[2]), hn::LoadU(d, tap + stride), column);
    column = hn::MulAdd(hn::Set(d, weights_y[4]), hn::LoadU(d, tap + 2 * stride), column);
    column = hn::MulAdd(hn::Set(d, weights_y[6]), hn::LoadU(d, tap + 3 * stride), column);
    hn::Store(hn::Mul(column, hn::Load(d, weights_x + i)), d, sums + i);
  }
  return {(sums[0] + sums[2]) + (sums[4] + sums[6]), (sums[1] + sums[3]) + (sums[5] + sums[7])};
}

void RenderView(std::span<const MappedPlane> planes, size_t side, const ViewPoint& from, size_t size, float* view) {
  static const WeightTable table;
  std::vector<RowOfRays> rays(planes.size());
  for (size_t row = 0; row < size; ++row) {
    for (size_t i = 0; i < rays.size(); ++i) rays[i] = row_of_rays(planes[i].plane, from, row, size, side);
    for (size_t column = 0; column < size; ++column) {
      const auto at = static_cast<float>(column);
      float light = 0, through = 1;
      for (size_t i = planes.size(); i-- > 0 && through > kHidden;) {
        const RowOfRays& ray = rays[i];
        Position met{ray.y + at * ray.step_y, ray.x + at * ray.step_x};
        if (!may_cover(planes[i], side, met)) continue;
        if (planes[i].relief != nullptr) met = meet_relief(planes[i].relief, side, from, met);
        const Sample seen = sample(planes[i].maps, side, table, met.y, met.x);
        const float coverage = std::clamp(seen.coverage, 0.0F, 1.0F);
        light += through * coverage * seen.brightness;
        through *= 1.0F - coverage;
      }
      *view++ = light;
    }
  }
}

}  // namespace
}  // namespace e2lf::learn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::learn {

HWY_EXPORT(RenderView);

void render_view(std::span<const MappedPlane> planes, size_t side, const ViewPoint& from, size_t size, float* view) {
  HWY_DYNAMIC_DISPATCH(RenderView)(planes, side, from, size, view);
}

}  // namespace e2lf::learn
#endif
