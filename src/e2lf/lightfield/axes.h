// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/lightfield/light_field_io.h"

/// Checks whether the numbers that were read are plausible for a light field.
namespace e2lf::lightfield {

/// Deviations from [0, 1] up to this size are rounding errors.
inline constexpr float kRangeTolerance = 1e-3F;

/// Returns false for NaN, infinity and values that the policy refuses, and clamps the others if the policy requires it.
[[nodiscard]] inline bool settle(float& value, RangePolicy policy) {
  if (policy == RangePolicy::kKeep) return std::fabs(value) <= kMostKept;
  const float clamped = std::clamp(value, 0.0F, 1.0F);
  const bool good =
      policy == RangePolicy::kClamp ? std::fabs(value) <= kMostKept : std::fabs(value - clamped) <= kRangeTolerance;
  value = clamped;
  return good;
}

/// Collects samples, some of which are outside of the requested range.
struct BadSamples {
  std::string first;                                                ///< the first sample out of range and its place
  float low = std::numeric_limits<float>::infinity(), high = -low;  ///< range of the finite samples, as stored
  size_t not_finite = 0;

  void add(float stored);
  /// Describes the problem and its remedy, as an error of kind kInvalidValue.
  [[nodiscard]] Error error(const std::string& location) const;
};

/// Checks the values of a light field against the assumed white, i.e. the stored number that was taken as 1 because
/// none was named (0 = one was named). Fails with kInvalidValue if the integers are those of a smaller type: 0 and 1 in
/// 8 bits, or 0 to 255 in 16 bits.
[[nodiscard]] Result<void> check_values(const LightField& light_field, float assumed_white,
                                        const std::string& location);

/// Checks that views have at least as many pixels as there are views along each axis. If they do not, the axes are
/// probably in another order: fails with kShape if an axis has more than 32 views, and warns otherwise.
[[nodiscard]] Result<void> check_axes(const Shape& stored, const std::string& location);

/// The distances in elements between neighbours along each axis of a stored light field. Each storage convention of the
/// field has a function below. The letters of the field (U, V, ...) are used only here, because the conventions use
/// them with opposite meanings.
struct AxisStrides {
  size_t view_y = 0, view_x = 0, y = 0, x = 0, channel = 0;
};

/// Returns the strides of row-major [U, V, H, W, C], where U is the view row: LightField itself, BasicLFSR in Python,
/// and [t, s, v, u, c] of LFToolbox.
[[nodiscard]] AxisStrides uvhwc_strides(const Shape& shape);
/// Returns the strides of column-major (U, V, H, W, C), which is a MATLAB array. Read from HDF5, it is row-major [C, W,
/// H, V, U].
[[nodiscard]] AxisStrides matlab_uvhwc_strides(const Shape& shape);
/// Returns the strides of a lenslet mosaic [H, U, W, V, C], in which the views of a pixel lie side by side (ESLF).
[[nodiscard]] AxisStrides huwvc_strides(const Shape& shape);
/// Returns the strides of a transposed grey mosaic of whole views [V, W, U, H]: `Hr_SAI_y` as BasicLFSR stores it.
[[nodiscard]] AxisStrides vwuh_strides(const Shape& shape);

/// Returns n such that num_views = n * n, or 0 if num_views is not a square.
[[nodiscard]] size_t views_per_axis(size_t num_views);

/// Returns the number that is white in samples of this numpy type: 255 in u1, 65535 in u2, 1 in floating-point numbers
/// and truth values, and 0 in other types, which do not determine it.
[[nodiscard]] float white_of_type(std::string_view code);

/// A light field as it is stored: samples in the byte order of this machine and in any axis order. `shape` describes
/// what is stored. `channels` may be any number: with three or more, the first three are red, green and blue; one or
/// two are read as grey.
struct StoredArray {
  Shape shape;
  AxisStrides strides;
  std::string type = "f4";  ///< the numpy code of the samples, such as "u1" or "f8"
  std::span<const uint8_t> bytes;
  float white = 1.0F;  ///< the stored number that means 1 unless ReadOptions names one; 0 = it is not known

  /// Returns the number of bytes that the shape needs.
  [[nodiscard]] size_t num_bytes() const;
};

struct RawImage;

/// Returns the samples of an image (see formats/readers.h) as a light field of one view, which points to them.
[[nodiscard]] StoredArray stored_view(const RawImage& image);

/// The views selected along one axis.
struct ChosenViews {
  size_t first = 0, step = 1, count = 0;
  size_t stored = 0;
  bool reversed = false;

  /// Returns the stored index of a selected view.
  [[nodiscard]] size_t operator[](size_t view) const {
    const size_t index = first + step * view;
    return reversed ? stored - 1 - index : index;
  }
};

struct ChosenGrid {
  ChosenViews y, x;
};

/// Applies options.views_y and views_x to the stored grid of views. Fails with kShape if it has too few views.
[[nodiscard]] Result<ChosenGrid> choose_views(size_t stored_y, size_t stored_x, const ReadOptions& options,
                                              const std::string& location);

/// Fails with kUnsupported if shape.size() samples of `bytes_each` bytes exceed options.max_bytes, and with kShape if
/// an extent is 0. The product cannot overflow.
[[nodiscard]] Result<void> check_memory(const Shape& shape, size_t bytes_each, const ReadOptions& options,
                                        const std::string& location);

/// Converts the selected views of a stored array to `out`, which has their number and size, in colour if it has three
/// channels and otherwise in grey. Fails with kInvalidValue as options.range demands.
[[nodiscard]] Result<void> convert_views(const StoredArray& array, const ChosenGrid& grid, const ReadOptions& options,
                                         const LightFieldOutput& out, const std::string& location);

/// Converts the selected views of a stored array to a light field, in grey or colour according to the options. Fails
/// with kUnsupported if it is not known which number is white, and as read_light_field does.
[[nodiscard]] Result<LightField> from_stored(const StoredArray& array, const ReadOptions& options,
                                             const std::string& location);

}  // namespace e2lf::lightfield
