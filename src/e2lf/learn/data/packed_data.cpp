// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/packed_data.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::learn {
namespace {

constexpr std::string_view kTexture = "texture/", kLightField = "lightfield/", kDisparity = "disparity/";

bool is_light_field(const std::vector<size_t>& shape) {
  return shape.size() == 4 && shape[0] == 8 && shape[1] == 8;
}

/// Removes the disparities from the tensors of a file. Returns them by the names of their light fields.
Result<std::map<std::string, Tensor>> take_disparities(Safetensors& file, const std::string& location) {
  std::map<std::string, Tensor> disparities;
  for (auto at = file.tensors.begin(); at != file.tensors.end();) {
    const auto& [name, tensor] = *at;
    if (!name.starts_with(kDisparity)) {
      ++at;
      continue;
    }
    if (tensor.type != "f4" || tensor.shape.size() != 3 || tensor.shape[0] != 4 || tensor.num_elements() == 0) {
      return fail(tensor.type == "f4" ? ErrorCode::kShape : ErrorCode::kFormat, location, "\"", name, "\" is ",
                  type_name(tensor), " ", shape_text(tensor.shape),
                  "; pack the data with `e2lf pack` (disparities F32 [4, y, x])");
    }
    disparities[name.substr(kDisparity.size())] = std::move(at->second);
    at = file.tensors.erase(at);
  }
  return disparities;
}

}  // namespace

bool is_packed_data(const Safetensors& file) {
  return std::any_of(file.tensors.begin(), file.tensors.end(), [](const auto& named) {
    return named.first.starts_with(kTexture) || named.first.starts_with(kLightField);
  });
}

Result<PackedData> sort_packed_data(Safetensors file, const std::string& location) {
  PackedData data;
  E2LF_ASSIGN_OR_RETURN(auto disparities, take_disparities(file, location));
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
      PackedPicture& added = data.light_fields.back();
      if (auto found = disparities.extract(added.name)) added.disparity = std::move(found.mapped());
    }
  }
  for (const PackedPicture& field : data.light_fields) {
    const auto &views = field.pixels.shape, &maps = field.disparity.shape;
    if (maps.empty() || (maps[1] == views[2] && maps[2] == views[3])) continue;
    return fail(ErrorCode::kShape, location, "the disparity of \"", field.name, "\" is ", shape_text(maps),
                ", but its views are ", shape_text(views), "; pack the data with `e2lf pack`");
  }
  if (!disparities.empty()) {
    return fail(ErrorCode::kFormat, location, "\"", kDisparity, disparities.begin()->first,
                "\" belongs to no light field; pack the data with `e2lf pack`");
  }
  return data;
}

}  // namespace e2lf::learn
