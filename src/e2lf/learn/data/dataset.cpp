// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/dataset.h"

#include "e2lf/base/text.h"
#include "e2lf/learn/data/packed_data.h"

namespace e2lf::learn {
namespace {

torch::Tensor to_torch(const Tensor& tensor, torch::Device device) {
  std::vector<int64_t> shape(tensor.shape.begin(), tensor.shape.end());
  // from_blob wants a mutable pointer; clone() makes our own copy at once.
  const auto type = tensor.type == "u1" ? torch::kByte : torch::kFloat;
  return torch::from_blob(const_cast<uint8_t*>(tensor.bytes.data()), shape, type).clone().to(device);
}

}  // namespace

Result<const Scene*> Dataset::find(const std::string& name) const {
  std::vector<std::string> names;
  for (const Scene& scene : scenes) {
    if (scene.name == name) return &scene;
    names.push_back(scene.name);
  }
  const std::string remedy = names.empty() ? "it has none; pack some with `e2lf pack`." : suggestion(name, names);
  return fail(ErrorCode::kNotFound, "data.file", "the packed data contain no light field \"", name, "\"; ", remedy);
}

Result<Dataset> read_dataset(const std::filesystem::path& path, torch::Device device) {
  Dataset dataset;
  if (path.empty()) return dataset;
  E2LF_ASSIGN_OR_RETURN(auto file, read_safetensors(path));
  E2LF_ASSIGN_OR_RETURN(const PackedData packed, sort_packed_data(std::move(file), path.string()));
  for (const PackedPicture& texture : packed.textures) dataset.textures.push_back(to_torch(texture.pixels, device));
  for (const PackedPicture& scene : packed.light_fields) {
    dataset.scenes.push_back({scene.name, views_last(to_torch(scene.pixels, device).flatten(0, 1))});
    if (!scene.disparity.shape.empty()) dataset.scenes.back().disparity = to_torch(scene.disparity, device);
  }
  return dataset;
}

torch::Tensor views_last(const torch::Tensor& views) {
  return views.permute({1, 2, 0}).contiguous().permute({2, 0, 1});
}

torch::Tensor transform_views(const torch::Tensor& views, unsigned symmetry) {
  auto field = views.permute({1, 2, 0}).reshape({views.size(1), views.size(2), 8, 8});
  if ((symmetry & 1U) != 0) field = field.flip({0, 2});
  if ((symmetry & 2U) != 0) field = field.flip({1, 3});
  if ((symmetry & 4U) != 0) field = field.transpose(0, 1).transpose(2, 3);
  return field.reshape({field.size(0), field.size(1), 64}).permute({2, 0, 1});
}

}  // namespace e2lf::learn
