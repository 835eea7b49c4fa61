// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/safetensors.h"

namespace e2lf::learn {

/// A light field or photograph of the packed data.
struct PackedPicture {
  std::string name;
  Tensor pixels;  ///< U8; [8, 8, y, x] for a light field, [y, x] for a photograph
};

/// The content of a file made by `e2lf pack`. Does not require torch.
struct PackedData {
  std::vector<PackedPicture> light_fields, textures;
};

/// Returns whether any tensor has a name of the form "lightfield/..." or "texture/...", as `e2lf pack` writes them.
[[nodiscard]] bool is_packed_data(const Safetensors& file);

/// Separates the tensors of a file into light fields and textures. `location` names the file in errors. Fails with
/// kFormat (a tensor that is neither, or not U8) and with kShape, naming the tensor.
[[nodiscard]] Result<PackedData> sort_packed_data(Safetensors file, const std::string& location);

}  // namespace e2lf::learn
