// SPDX-License-Identifier: MIT
#include "e2lf/recon/reconstruct.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/recon/grid_shift.h"
#include "e2lf/recon/input.h"

namespace e2lf::recon {
namespace {

/// `cropped` [channel, height, width] += weight * the part of `planes` [channel, full_height, full_width] from `from`
/// on.
void add_crop(const std::vector<float>& planes, size_t full_height, size_t full_width, const GridShift& from,
              size_t height, size_t width, float weight, std::vector<float>& cropped) {
  const size_t rows = cropped.size() / width;
  for (size_t row = 0; row < rows; ++row) {
    const size_t channel = row / height, y = row % height + from.y;
    const float* source = planes.data() + (channel * full_height + y) * full_width + from.x;
    for (size_t x = 0; x < width; ++x) cropped[row * width + x] += weight * source[x];
  }
}

/// Progress of one pass among several.
ProgressFn part_of(const ProgressFn& progress, size_t pass, size_t passes) {
  if (!progress) return {};
  return [=](size_t done, size_t total) { progress(pass * total + done, passes * total); };
}

}  // namespace

Result<Reconstructor> Reconstructor::create(model::Model model, const engine::EngineOptions& options) {
  E2LF_RETURN_IF_ERROR(model::validate(model, model.name));
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model.network, model.weights, options));
  return Reconstructor(std::move(model), std::move(engine));
}

Result<std::vector<float>> Reconstructor::run(const events::EventImages& images, const ProgressFn& progress) const {
  E2LF_ASSIGN_OR_RETURN(const InputPlanes input,
                        network_input(images, model_.input, model_.constants, model::size_multiple(model_.network)));
  const size_t num_views = model_.views_y * model_.views_x;
  std::vector<float> views(num_views * input.height * input.width);
  E2LF_RETURN_IF_ERROR(engine_.run(input.values, input.height, input.width, views, progress));
  if (input.height == images.height && input.width == images.width) return views;
  std::vector<float> cropped(num_views * images.image_size());
  add_crop(views, input.height, input.width, {}, images.height, images.width, 1.0F, cropped);
  return cropped;
}

Result<lightfield::LightField> Reconstructor::reconstruct(const events::EventImages& images, const ProgressFn& progress,
                                                          size_t passes) const {
  if (images.transitions + 1 != model_.num_patterns || images.image_size() == 0) {
    return Error{ErrorCode::kShape,
                 cat("there are ", images.transitions, " event images of ", images.width, "x", images.height,
                     " but the model was trained for ", model_.num_patterns - 1,
                     "; use the model that belongs to the patterns of the recording"),
                 ""};
  }
  const lightfield::Shape shape{model_.views_y, model_.views_x, images.height, images.width};
  const auto shifts = grid_shifts(passes, model::size_multiple(model_.network));
  if (shifts.size() <= 1) {
    E2LF_ASSIGN_OR_RETURN(auto views, run(images, progress));
    return lightfield::LightField(shape, std::move(views));
  }
  std::vector<float> mean(shape.size());
  for (size_t pass = 0; pass < shifts.size(); ++pass) {
    const events::EventImages shifted = extend(images, shifts[pass]);
    E2LF_ASSIGN_OR_RETURN(const auto views, run(shifted, part_of(progress, pass, shifts.size())));
    add_crop(views, shifted.height, shifted.width, shifts[pass], images.height, images.width,
             1.0F / static_cast<float>(shifts.size()), mean);
  }
  return lightfield::LightField(shape, std::move(mean));
}

}  // namespace e2lf::recon
