// SPDX-License-Identifier: MIT
#include "e2lf/view/light_field_cycles.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::view {
namespace fs = std::filesystem;
namespace {

/// Returns the size of the views in graphics memory: one byte per grey pixel, and four per colour pixel.
uint64_t browser_bytes(const lightfield::Shape& shape) {
  return uint64_t{shape.num_views()} * shape.height * shape.width * (shape.channels == 1 ? 1 : 4);
}

}  // namespace

Result<void> check_browser_memory(const lightfield::Shape& shape, const fs::path& path) {
  if (browser_bytes(shape) <= LightFieldCycles::kMostBytes) return {};
  return Error{ErrorCode::kUnsupported,
               cat("its ", shape.num_views(), " views need ", browser_bytes(shape) >> 20,
                   " MiB in the browser, more than ", LightFieldCycles::kMostBytes >> 20, "; show fewer"),
               path.string(), "views"};
}

Result<std::shared_ptr<LightFieldCycles>> LightFieldCycles::open(const fs::path& path,
                                                                 const lightfield::ReadOptions& options) {
  std::vector<fs::path> paths = lightfield::cycle_folders(path);
  if (paths.empty()) paths.push_back(path);
  std::shared_ptr<LightFieldCycles> cycles(new LightFieldCycles(std::move(paths), options));
  E2LF_ASSIGN_OR_RETURN(auto first, lightfield::read_light_field(cycles->paths_.front(), options));
  cycles->shape_ = first.shape();
  E2LF_RETURN_IF_ERROR(check_browser_memory(first.shape(), path));
  cycles->kept_ = std::make_shared<const lightfield::LightField>(std::move(first));
  return cycles;
}

void LightFieldCycles::add(const std::string& name, lightfield::LightField light_field) {
  E2LF_REQUIRE(paths_.empty() || light_field.shape() == shape_, "the cycles of a recording have one shape");
  shape_ = light_field.shape();
  added_.push_back(std::make_shared<const lightfield::LightField>(std::move(light_field)));
  paths_.emplace_back(name);
}

std::string LightFieldCycles::label(size_t cycle) const {
  std::string name = paths_[cycle].filename().string();
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Result<std::shared_ptr<const lightfield::LightField>> LightFieldCycles::read(size_t cycle) {
  if (!added_.empty()) return added_.at(cycle);
  const std::lock_guard lock(mutex_);
  if (kept_ && kept_cycle_ == cycle) return kept_;
  const fs::path& path = paths_[cycle];
  E2LF_ASSIGN_OR_RETURN(auto light_field, lightfield::read_light_field(path, options_));
  if (!(light_field.shape() == shape_)) {
    return fail(ErrorCode::kShape, path, "has another size than the first cycle; show it separately");
  }
  kept_ = std::make_shared<const lightfield::LightField>(std::move(light_field));
  kept_cycle_ = cycle;
  return kept_;
}

Result<std::vector<uint8_t>> LightFieldCycles::png(size_t cycle, size_t view) {
  E2LF_ASSIGN_OR_RETURN(const auto light_field, read(cycle));
  const lightfield::Shape& shape = light_field->shape();
  const std::span<const float> pixels = light_field->view(view / shape.views_x, view % shape.views_x);
  lightfield::Image image(shape.width, shape.height, shape.channels);
  image.pixels.assign(pixels.begin(), pixels.end());
  return lightfield::encode_png(lightfield::to_bytes(image));
}

}  // namespace e2lf::view
