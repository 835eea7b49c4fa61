// SPDX-License-Identifier: MIT
// The operations of geometry by plain loops, as the reference for their kernels.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/geometry/operations.h"
#include "e2lf/geometry/shift.h"
#include "testing/engine_reference.h"

namespace e2lf::geometry::reference {

using engine::ReferenceCall, engine::ReferencePlanes;

/// Reads a channel at a shifted place, linearly and with zeros outside.
inline double read_at(const ReferencePlanes& input, size_t c, size_t y, size_t x, const LinearShift& down,
                      const LinearShift& across) {
  double sum = 0.0;
  for (size_t i = 0; i < 2; ++i) {
    for (size_t j = 0; j < 2; ++j) {
      const auto at = [](size_t place, ptrdiff_t first, size_t tap) {
        return static_cast<ptrdiff_t>(place + tap) + first;
      };
      sum += static_cast<double>(down.weights[i]) * across.weights[j] *
             input.at_or_zero(c, at(y, down.first, i), at(x, across.first, j));
    }
  }
  return sum;
}

/// Sums of the products and of the squares of a pixel, before they are averaged over windows.
inline std::pair<double, double> products_at(const ReferencePlanes& input, const Sweep& sweep, size_t k, size_t y,
                                             size_t x) {
  double products = 0.0, squares = 0.0;
  for (size_t feature = 0; feature < sweep.features; ++feature) {
    double sum = 0.0, own = 0.0;
    for (size_t p = 0; p < sweep.pictures; ++p) {
      const size_t n = k * sweep.pictures + p;
      const double value = read_at(input, p * sweep.features + feature, y, x, sweep.down[n], sweep.across[n]);
      sum += value;
      own += value * value;
    }
    products += 0.5 * (sum * sum - own);
    squares += own;
  }
  const auto features = static_cast<double>(sweep.features);
  return {products / features, squares / features};
}

inline Result<ReferencePlanes> sweep_reference(ReferenceCall& call) {
  const ReferencePlanes& input = *call.inputs[0];
  const Sweep sweep(call.layer, input.channels);
  ReferencePlanes evidence(sweep.disparities, input.height, input.width), energy = evidence;
  evidence.fill([&](size_t k, size_t y, size_t x) {
    const auto [products, squares] = products_at(input, sweep, k, y, x);
    energy.at(k, y, x) = static_cast<float>(squares);
    return static_cast<float>(products);
  });
  const auto radius = static_cast<ptrdiff_t>(sweep.kernel / 2);
  call.output.fill([&](size_t k, size_t y, size_t x) {
    double products = 0.0, squares = 0.0;
    for (ptrdiff_t dy = -radius; dy <= radius; ++dy) {
      for (ptrdiff_t dx = -radius; dx <= radius; ++dx) {
        products += evidence.at_or_zero(k, static_cast<ptrdiff_t>(y) + dy, static_cast<ptrdiff_t>(x) + dx);
        squares += energy.at_or_zero(k, static_cast<ptrdiff_t>(y) + dy, static_cast<ptrdiff_t>(x) + dx);
      }
    }
    const auto area = static_cast<double>(sweep.kernel * sweep.kernel);
    return static_cast<float>(products / area / (1 + squares / area));
  });
  return std::move(call.output);
}

/// Reads a plane at a shifted place; edges are repeated.
inline double read_cubic(const ReferencePlanes& planes, size_t c, size_t y, size_t x, const CubicShift& down,
                         const CubicShift& across) {
  const auto place = [](size_t at, ptrdiff_t first, size_t tap, size_t size) {
    return static_cast<size_t>(
        std::clamp<ptrdiff_t>(static_cast<ptrdiff_t>(at + tap) + first, 0, static_cast<ptrdiff_t>(size) - 1));
  };
  double sum = 0.0;
  for (size_t i = 0; i < 4; ++i) {
    for (size_t j = 0; j < 4; ++j) {
      sum += static_cast<double>(down.weights[i]) * across.weights[j] *
             planes.at(c, place(y, down.first, i, planes.height), place(x, across.first, j, planes.width));
    }
  }
  return sum;
}

inline Result<ReferencePlanes> render_reference(ReferenceCall& call) {
  const Viewpoints viewpoints(call.layer);
  const size_t planes = viewpoints.planes;
  ReferencePlanes maps = *call.inputs[0];
  maps.fill([&](size_t c, size_t y, size_t x) {
    const double value = maps.at(c, y, x);
    if (c + 1 == planes) return 1.0F;
    return static_cast<float>(c < planes ? 1 / (1 + std::exp(-value)) : value);
  });
  call.output.fill([&](size_t view, size_t y, size_t x) {
    const CubicShift* const down = &viewpoints.down[view / viewpoints.columns * planes];
    const CubicShift* const across = &viewpoints.across[view % viewpoints.columns * planes];
    double sum = 0.0, passed = 1.0;
    for (size_t plane = 0; plane < planes; ++plane) {
      const double opacity = read_cubic(maps, plane, y, x, down[plane], across[plane]);
      const double share = passed * std::clamp(opacity, 0.0, 1.0);
      sum += share * read_cubic(maps, planes + plane, y, x, down[plane], across[plane]);
      passed -= share;
    }
    return static_cast<float>(sum);
  });
  return std::move(call.output);
}

inline Result<ReferencePlanes> warp_reference(ReferenceCall& call) {
  const ReferencePlanes &pictures = *call.inputs[0], &map = *call.inputs[1];
  const Warp warp(call.layer);
  call.output.fill([&](size_t c, size_t y, size_t x) {
    const double d = std::clamp<double>(map.at(0, y, x), warp.least, warp.most);
    const size_t p = c % warp.pictures();
    const auto place = [&](size_t at, size_t axis, size_t size) {
      return std::clamp(static_cast<double>(at) + warp.offsets[2 * p + axis] * d, 0.0, static_cast<double>(size - 1));
    };
    const double row = place(y, 0, pictures.height), column = place(x, 1, pictures.width);
    const auto top = static_cast<size_t>(row), left = static_cast<size_t>(column);
    double sum = 0;
    for (size_t at_y = top; at_y < std::min(top + 2, pictures.height); ++at_y) {
      for (size_t at_x = left; at_x < std::min(left + 2, pictures.width); ++at_x) {
        const double share_y = 1 - std::abs(row - static_cast<double>(at_y));
        const double share_x = 1 - std::abs(column - static_cast<double>(at_x));
        sum += share_y * share_x * pictures.at(c, at_y, at_x);
      }
    }
    return static_cast<float>(sum);
  });
  return std::move(call.output);
}

/// Lets run_reference() compute them.
inline const bool g_is_added = [] {
  engine::added_references().insert({{GeometryOp::kPlaneSweep, sweep_reference},
                                     {GeometryOp::kRenderLayers, render_reference},
                                     {GeometryOp::kWarp, warp_reference}});
  return true;
}();

}  // namespace e2lf::geometry::reference
