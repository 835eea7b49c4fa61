// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <torch/types.h>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::learn {

struct Scene {
  std::string name;
  torch::Tensor views;  ///< uint8 [64, y, x], view number = 8 * view_y + view_x
};

/// Packed training data in memory: textures and light fields, 8-bit grey.
struct Dataset {
  std::vector<torch::Tensor> textures;  ///< uint8 [y, x]
  std::vector<Scene> scenes;

  /// The scene of that name. Fails with kNotFound and the nearest name.
  [[nodiscard]] Result<const Scene*> find(const std::string& name) const;
};

/// Reads a file made by `e2lf pack` (an empty path: no data, procedural textures only): tensors "texture/<name>" U8 [y,
/// x] and "lightfield/<name>" U8 [8, 8, y, x]. An empty path: no data. Fails with kFormat and kShape, naming the
/// tensor.
[[nodiscard]] Result<Dataset> read_dataset(const std::filesystem::path& path, torch::Device device);

/// [64, y, x] with the views of a pixel beside each other in memory, as training reads them.
[[nodiscard]] torch::Tensor views_last(const torch::Tensor& views);

/// One of the eight symmetries of a light field, jointly over views and pixels: bit 0 flips y, bit 1 flips x, bit 2
/// transposes. views: [64, y, x] of any type; the result's views are last in memory.
[[nodiscard]] torch::Tensor transform_views(const torch::Tensor& views, unsigned symmetry);

}  // namespace e2lf::learn
