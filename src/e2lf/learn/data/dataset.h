// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <torch/types.h>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::learn {

/// The grid of views of training data.
inline constexpr int64_t kViewsPerSide = 8, kViews = 64, kCentre = 36;  // view (4, 4)

struct Scene {
  std::string name;
  torch::Tensor views;  ///< uint8 [64, y, x], view number = 8 * view_y + view_x
  /// Of the views (3, 3), (3, 4), (4, 3), (4, 4), px per view step, NaN where it is not known: float32 [4, y, x];
  /// undefined if it is not known at all.
  torch::Tensor disparity = {};
};

/// Packed training data in memory: textures and light fields, 8-bit grey.
struct Dataset {
  std::vector<torch::Tensor> textures;  ///< uint8 [y, x]
  std::vector<Scene> scenes;

  /// Returns the scene with this name. Fails with kNotFound, suggesting the nearest name.
  [[nodiscard]] Result<const Scene*> find(const std::string& name) const;
};

/// Reads a file made by `e2lf pack`: tensors "texture/<name>" U8 [y, x], "lightfield/<name>" U8 [8, 8, y, x] and
/// "disparity/<name>" F32 [4, y, x]. If the path is empty, returns an empty data set, so that only procedural textures
/// are used. Fails with kFormat and kShape, naming the tensor.
[[nodiscard]] Result<Dataset> read_dataset(const std::filesystem::path& path, torch::Device device);

/// Returns `views` [64, y, x] in a memory layout in which the views of a pixel are adjacent, as training reads them.
[[nodiscard]] torch::Tensor views_last(const torch::Tensor& views);

/// Applies one of the eight symmetries of a light field jointly to views and pixels: bit 0 flips y, bit 1 flips x, and
/// bit 2 transposes. `views` is [64, y, x] of any type; in the result the views are last in memory.
[[nodiscard]] torch::Tensor transform_views(const torch::Tensor& views, unsigned symmetry);

}  // namespace e2lf::learn
