// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/safetensors.h"

namespace e2lf::learn {

/// A light field or photograph of packed data.
struct PackedPicture {
  std::string name;
  Tensor pixels;  ///< U8; [8, 8, y, x] of a light field, [y, x] of a photograph
};

/// What a file made by `e2lf pack` holds. Does not need torch.
struct PackedData {
  std::vector<PackedPicture> light_fields, textures;
};

/// True if a tensor is named as `e2lf pack` names them: "lightfield/..." or "texture/...".
[[nodiscard]] bool is_packed_data(const Safetensors& file);

/// Sorts the tensors of a file by what they are. `location` names the file in errors. Fails with kFormat for a tensor
/// that is neither or not U8, and with kShape, naming the tensor.
[[nodiscard]] Result<PackedData> sort_packed_data(Safetensors file, const std::string& location);

}  // namespace e2lf::learn
