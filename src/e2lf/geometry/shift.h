// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/model/network.h"

/// Shifts by fractions of a pixel along an axis; internal to this module.
namespace e2lf::geometry {

/// A shift: (M x)[i] is the sum of weights[n] x[i + first + n].
template <size_t kTaps>
struct Shift {
  ptrdiff_t first = 0;
  std::array<float, kTaps> weights = {};
};

using LinearShift = Shift<2>;
using CubicShift = Shift<4>;

inline LinearShift linear_shift(double offset) {
  const double whole = std::floor(offset), t = offset - whole;
  return {static_cast<ptrdiff_t>(whole), {static_cast<float>(1 - t), static_cast<float>(t)}};
}

/// The cubic of Keys with a = -1/2.
inline CubicShift cubic_shift(double offset) {
  const double whole = std::floor(offset), t = offset - whole;
  const auto near = [](double u) { return (1.5 * u - 2.5) * u * u + 1; };
  const auto far = [](double u) { return ((-0.5 * u + 2.5) * u - 4) * u + 2; };
  return {static_cast<ptrdiff_t>(whole) - 1,
          {static_cast<float>(far(t + 1)), static_cast<float>(near(t)), static_cast<float>(near(1 - t)),
           static_cast<float>(far(2 - t))}};
}

/// Returns the largest number of pixels that a shift reads beside the one at its place.
template <size_t kTaps>
size_t reach_of(const std::vector<Shift<kTaps>>& shifts) {
  ptrdiff_t reach = 0;
  for (const Shift<kTaps>& shift : shifts) {
    reach = std::max({reach, -shift.first, shift.first + static_cast<ptrdiff_t>(kTaps) - 1});
  }
  return static_cast<size_t>(reach);
}

/// Returns the values of an attribute, or none.
inline std::vector<double> numbers(const model::Layer& layer, const std::string& attribute) {
  const auto found = layer.attributes.find(attribute);
  return found == layer.attributes.end() ? std::vector<double>() : found->second;
}

/// Returns the products of all positions and disparities, [position, disparity].
inline std::vector<double> products(const std::vector<double>& positions, const std::vector<double>& disparities) {
  std::vector<double> result;
  for (const double position : positions) {
    for (const double disparity : disparities) result.push_back(position * disparity);
  }
  return result;
}

inline constexpr size_t kMostDisparities = 256;
inline constexpr double kMostShiftPx = 64;

/// Fails with kInvalidValue unless there are positions and disparities, and no shift exceeds kMostShiftPx.
inline Result<void> check_shifts(const std::vector<double>& positions, const std::vector<double>& disparities) {
  const auto refuse = [](const std::string& message) { return fail(ErrorCode::kInvalidValue, "", message); };
  if (positions.empty()) return refuse("no viewpoints; give at least one");
  if (disparities.empty() || disparities.size() > kMostDisparities) {
    return refuse(cat(disparities.size(), " disparities; give 1 to ", kMostDisparities));
  }
  for (const double shift : products(positions, disparities)) {
    if (!(std::abs(shift) <= kMostShiftPx)) return refuse(cat("a shift by ", shift, " px; use at most ", kMostShiftPx));
  }
  return {};
}

/// The shifts of a layer of GeometryOp::kPlaneSweep.
struct Sweep {
  size_t pictures, features, disparities, kernel;
  std::vector<LinearShift> down, across;  ///< [disparity, picture]
  size_t reach;                           ///< of the shifts

  Sweep(const model::Layer& layer, size_t channels) : kernel(layer.kernel) {
    const std::vector<double> offsets = numbers(layer, "offsets"), planes = numbers(layer, "disparities");
    pictures = offsets.size() / 2;
    features = channels / pictures;
    disparities = planes.size();
    for (const double disparity : planes) {
      for (size_t p = 0; p < pictures; ++p) {
        down.push_back(linear_shift(offsets[2 * p] * disparity));
        across.push_back(linear_shift(offsets[2 * p + 1] * disparity));
      }
    }
    reach = std::max(reach_of(down), reach_of(across));
  }

  [[nodiscard]] size_t channels() const { return pictures * features; }
};

/// Where a layer of GeometryOp::kWarp reads its pictures.
struct Warp {
  std::vector<double> offsets;  ///< [picture, axis], in view steps
  float least, most;            ///< disparities, px per view step
  size_t reach;                 ///< px

  explicit Warp(const model::Layer& layer) : offsets(numbers(layer, "offsets")) {
    const std::vector<double> range = numbers(layer, "disparities");
    least = static_cast<float>(range[0]);
    most = static_cast<float>(range[1]);
    double farthest = 0;
    for (const double shift : products(offsets, range)) farthest = std::max(farthest, std::abs(shift));
    reach = static_cast<size_t>(std::ceil(farthest)) + 1;
  }

  [[nodiscard]] size_t pictures() const { return offsets.size() / 2; }
};

/// The shifts of a layer of GeometryOp::kRenderLayers.
struct Viewpoints {
  size_t planes, rows, columns;
  std::vector<CubicShift> down, across;  ///< [row, plane] and [column, plane]
  size_t reach;

  explicit Viewpoints(const model::Layer& layer) {
    const std::vector<double> disparities = numbers(layer, "disparities");
    const std::vector<double> rows_at = numbers(layer, "rows"), columns_at = numbers(layer, "columns");
    planes = disparities.size();
    rows = rows_at.size();
    columns = columns_at.size();
    for (const double shift : products(rows_at, disparities)) down.push_back(cubic_shift(-shift));
    for (const double shift : products(columns_at, disparities)) across.push_back(cubic_shift(-shift));
    reach = std::max(reach_of(down), reach_of(across));
  }

  [[nodiscard]] size_t views() const { return rows * columns; }
};

}  // namespace e2lf::geometry
