// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/packed_data.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::learn {
namespace {

constexpr std::string_view kTexture = "texture/", kLightField = "lightfield/";

Error misfit(ErrorCode code, const std::string& name, const Tensor& tensor, const std::string& location) {
  return Error{code,
               cat("\"", name, "\" is ", tensor.type, " ", shape_text(tensor.shape),
                   "; pack the data with `e2lf pack` (textures U8 [y, x], light fields U8 [8, 8, y, x])"),
               location};
}

bool has_pixels(const Tensor& tensor) {
  return tensor.num_elements() > 0;
}

bool is_light_field(const Tensor& tensor) {
  return tensor.shape.size() == 4 && tensor.shape[0] == 8 && tensor.shape[1] == 8 && has_pixels(tensor);
}

bool is_texture(const Tensor& tensor) {
  return tensor.shape.size() == 2 && has_pixels(tensor);
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
    if ((!texture && !name.starts_with(kLightField)) || tensor.type != "U8") {
      return misfit(ErrorCode::kFormat, name, tensor, location);
    }
    if (!(texture ? is_texture(tensor) : is_light_field(tensor))) {
      return misfit(ErrorCode::kShape, name, tensor, location);
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
