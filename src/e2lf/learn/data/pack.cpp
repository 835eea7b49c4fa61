// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "e2lf/base/text.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/files/file.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/learn/data/packed_data.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::learn {
namespace {

namespace fs = std::filesystem;
constexpr size_t kSmallestTexture = 64;
constexpr float kSure = 0.2F;  // least confidence of an estimated disparity

/// A folder's or file's name without extension; of "scene/" too.
std::string name_of(const fs::path& path) {
  const fs::path clean = path.has_filename() ? path : path.parent_path();
  return fs::is_directory(clean) ? clean.filename().string() : clean.stem().string();
}

bool is_picture(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

Result<std::vector<fs::path>> list_pictures(const std::vector<fs::path>& roots) {
  std::vector<fs::path> pictures;
  for (const fs::path& root : roots) {
    std::error_code status;
    if (!fs::exists(root, status)) return fail(ErrorCode::kNotFound, root, "no such file or folder; check the path");
    if (!fs::is_directory(root)) {
      pictures.push_back(root);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(root, status)) {
      if (entry.is_regular_file() && is_picture(entry.path())) pictures.push_back(entry.path());
    }
    if (status) return fail(ErrorCode::kIo, root, "cannot list the folder; ", status.message());
  }
  std::sort(pictures.begin(), pictures.end());
  return pictures;
}

std::vector<uint8_t> to_bytes(std::span<const float> values) {
  std::vector<uint8_t> bytes(values.size());
  std::transform(values.begin(), values.end(), bytes.begin(),
                 [](float value) { return static_cast<uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))); });
  return bytes;
}

Result<void> insert(Safetensors& file, const std::string& name, std::vector<size_t> shape,
                    std::span<const float> values, const fs::path& source) {
  const bool fresh = file.tensors.try_emplace(name, make_npy<uint8_t>(std::move(shape), to_bytes(values))).second;
  if (fresh) return {};
  return fail(ErrorCode::kInvalidValue, source, "two inputs are named \"", name, "\"; rename one of them");
}

/// Returns the disparities of the four central views, NaN where they are not known; nothing if none is known.
Result<std::vector<float>> disparities_of(const lightfield::LightField& field, const fs::path& path, bool estimates) {
  const size_t pixels = field.shape().height * field.shape().width;
  std::vector<float> maps;
  for (size_t view = 0; estimates && view < 4; ++view) {
    E2LF_ASSIGN_OR_RETURN(const depth::DisparityMap map,
                          depth::estimate_disparity(field, {depth::ViewIndex{3 + view / 2, 3 + view % 2}, {}}));
    for (size_t i = 0; i < pixels; ++i) {
      const bool is_sure = map.confidence.pixels[i] > kSure;
      maps.push_back(is_sure ? map.disparity.pixels[i] : std::numeric_limits<float>::quiet_NaN());
    }
  }
  const auto file = depth::find_true_disparity(path);
  if (!file) return maps;
  E2LF_ASSIGN_OR_RETURN(const depth::TrueDisparity truth, depth::true_disparity(field, file));
  if (depth::has_comparable_disparity(field.shape())) {
    E2LF_RETURN_IF_ERROR(depth::check_true_disparity(field, truth));
  }
  maps.resize(4 * pixels, std::numeric_limits<float>::quiet_NaN());
  std::ranges::copy(truth.disparity.pixels, maps.end() - static_cast<ptrdiff_t>(pixels));
  return maps;
}

Result<void> add_light_field(Safetensors& file, const fs::path& path, const PackOptions& options,
                             PackSummary& summary) {
  E2LF_ASSIGN_OR_RETURN(const auto field, lightfield::read_light_field(path));
  const auto& shape = field.shape();
  E2LF_RETURN_IF_ERROR(insert(file, "lightfield/" + name_of(path),
                              {shape.views_y, shape.views_x, shape.height, shape.width}, field.data(), path));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> maps, disparities_of(field, path, options.estimate_disparity));
  if (maps.empty()) return {};
  ++summary.with_disparity;
  file.tensors["disparity/" + name_of(path)] = make_npy<float>({4, shape.height, shape.width}, maps);
  return {};
}

Result<void> add_texture(Safetensors& file, const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(auto image, lightfield::read_image(path));
  if (std::min(image.width, image.height) < kSmallestTexture) {
    return fail(ErrorCode::kInvalidValue, path, "the image must have at least 64x64 px; remove it from the inputs");
  }
  image = lightfield::to_grey(std::move(image));
  return insert(file, cat("texture/", path.parent_path().filename().string(), "/", path.stem().string()),
                {image.height, image.width}, image.pixels, path);
}

}  // namespace

Result<PackSummary> pack(const fs::path& output, const PackOptions& options, const ProgressFn& progress) {
  E2LF_RETURN_IF_ERROR(check_output(output, /*overwrite=*/false));
  E2LF_ASSIGN_OR_RETURN(const auto pictures, list_pictures(options.textures));
  const size_t total = options.light_fields.size() + pictures.size();
  if (total == 0)
    return fail(ErrorCode::kInvalidValue, "", "no light fields and no images were given; name at least one");

  Safetensors file;
  PackSummary summary{options.light_fields.size(), pictures.size()};
  size_t done = 0;
  const auto report = [&] {
    if (progress) progress(++done, total);
  };
  for (const fs::path& path : options.light_fields) {
    E2LF_RETURN_IF_ERROR(add_light_field(file, path, options, summary));
    report();
  }
  for (const fs::path& path : pictures) {
    E2LF_RETURN_IF_ERROR(add_texture(file, path));
    report();
  }
  for (const auto& [name, tensor] : file.tensors) summary.bytes += tensor.bytes.size();
  E2LF_RETURN_IF_ERROR(write_safetensors(output, file));
  return summary;
}

}  // namespace e2lf::learn
