// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/packed_data.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::learn {
namespace {

constexpr std::string_view kTexture = "texture/", kLightField = "lightfield/";

bool is_light_field(const std::vector<size_t>& shape) {
  return shape.size() == 4 && shape[0] == 8 && shape[1] == 8;
}

}  // namespace

bool is_packed_data(const Safetensors& file) {
  return std::any_of(file.tensors.begin(), file.tensors.end(), [](const auto& named) {
    return named.first.starts_with(kTexture) || named.first.starts_with(kLightField);
  });
}

Result<PackedData> sort_packed_data(Safetensors file, const std::string& location) {
  PackedData data;
  for (auto& [name, tensor] : file.tensors) {
    const bool texture = name.starts_with(kTexture);
    const bool is_ours = (texture || name.starts_with(kLightField)) && tensor.type == "u1";
    const bool has_shape = texture ? tensor.shape.size() == 2 : is_light_field(tensor.shape);
    if (!is_ours || !has_shape || tensor.num_elements() == 0) {
      return fail(is_ours ? ErrorCode::kShape : ErrorCode::kFormat, location, "\"", name, "\" is ", type_name(tensor),
                  " ", shape_text(tensor.shape),
                  "; pack the data with `e2lf pack` (textures U8 [y, x], light fields U8 [8, 8, y, x])");
    }
    if (texture) {
      data.textures.push_back({name.substr(kTexture.size()), std::move(tensor)});
    } else {
      data.light_fields.push_back({name.substr(kLightField.size()), std::move(tensor)});
    }
  }
  return data;
}

}  // namespace e2lf::learn
