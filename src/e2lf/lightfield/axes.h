// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {

/// Distances in elements between neighbours along each axis of a stored light field. Every convention of the field is
/// one of the functions below; the field's letters are used only here, because it uses them for opposite things.
struct AxisStrides {
  size_t view_y = 0, view_x = 0, y = 0, x = 0, channel = 0;
};

/// Row-major [U, V, H, W, C], U = view row: LightField itself, BasicLFSR in Python, and LFToolbox's [t, s, v, u, c].
[[nodiscard]] AxisStrides uvhwc_strides(const Shape& shape);
/// Column-major (U, V, H, W, C), a MATLAB array; read from HDF5 it is row-major [C, W, H, V, U].
[[nodiscard]] AxisStrides matlab_uvhwc_strides(const Shape& shape);
/// Lenslet mosaic [H, U, W, V, C]: the views of one pixel side by side (ESLF).
[[nodiscard]] AxisStrides huwvc_strides(const Shape& shape);
/// Grey mosaic of whole views, transposed [V, W, U, H]: `Hr_SAI_y` as BasicLFSR stores it.
[[nodiscard]] AxisStrides vwuh_strides(const Shape& shape);

/// n where num_views = n * n; 0 where there is none.
[[nodiscard]] size_t views_per_axis(size_t num_views);

enum class SampleType { kUint8, kUint16, kFloat32, kFloat64 };
[[nodiscard]] size_t sample_bytes(SampleType type);

/// A light field as stored: samples of this machine's byte order in any axis order. `shape` counts what is stored, and
/// `channels` may be any number: one is grey, the first three of more are red, green, blue, two are taken as grey.
struct StoredArray {
  Shape shape;
  AxisStrides strides;
  SampleType type = SampleType::kFloat32;
  std::span<const uint8_t> bytes;
  float white =
      0.0F;  ///< the number that is 1 where ReadOptions names none; 0 = the largest of an integer type, else 1
};

/// The number that is 1: what options name, else what the array says.
[[nodiscard]] float white_of(const StoredArray& array, const ReadOptions& options);

/// The views taken along one axis.
struct ChosenViews {
  size_t first = 0, step = 1, count = 0;
  size_t stored = 0;
  bool reversed = false;

  /// The stored index of a taken view.
  [[nodiscard]] size_t operator[](size_t view) const {
    const size_t index = first + step * view;
    return reversed ? stored - 1 - index : index;
  }
};

struct ChosenGrid {
  ChosenViews y, x;
};

/// Applies options.views_y and views_x to what is stored. Fails with kShape where that is not enough.
[[nodiscard]] Result<ChosenGrid> choose_views(size_t stored_y, size_t stored_x, const ReadOptions& options,
                                              const std::string& location);

/// Fails with kUnsupported when `samples` samples of `bytes_each` exceed options.max_bytes; safe from overflow.
[[nodiscard]] Result<void> check_memory(const Shape& shape, size_t bytes_each, const ReadOptions& options,
                                        const std::string& location);

/// The chosen views of a stored array as a light field, grey or colour as options say. Fails as read_light_field does.
[[nodiscard]] Result<LightField> from_stored(const StoredArray& array, const ReadOptions& options,
                                             const std::string& location);

}  // namespace e2lf::lightfield
