// SPDX-License-Identifier: MIT
#include "e2lf/recon/reconstruct.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/recon/input.h"

namespace e2lf::recon {
namespace {

/// The upper left part [channel, height, width] of planes.
std::vector<float> crop(const std::vector<float>& values, const InputPlanes& size, size_t height, size_t width) {
  const size_t channels = values.size() / (size.height * size.width);
  std::vector<float> cropped(channels * height * width);
  for (size_t row = 0; row < channels * height; ++row) {
    const size_t channel = row / height, y = row % height;
    std::copy_n(values.data() + (channel * size.height + y) * size.width, width, cropped.data() + row * width);
  }
  return cropped;
}

}  // namespace

Result<Reconstructor> Reconstructor::create(model::Model model, const engine::EngineOptions& options) {
  E2LF_RETURN_IF_ERROR(model::validate(model, model.name));
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model.network, model.weights, options));
  return Reconstructor(std::move(model), std::move(engine));
}

Result<lightfield::LightField> Reconstructor::reconstruct(const events::EventImages& images,
                                                          const ProgressFn& progress) const {
  if (images.transitions + 1 != model_.num_patterns || images.image_size() == 0) {
    return Error{ErrorCode::kShape,
                 cat("there are ", images.transitions, " event images of ", images.width, "x", images.height,
                     " but the model was trained for ", model_.num_patterns - 1,
                     "; use the model that belongs to the patterns of the recording"),
                 ""};
  }
  E2LF_ASSIGN_OR_RETURN(const InputPlanes input,
                        network_input(images, model_.input, model_.constants, model::size_multiple(model_.network)));
  std::vector<float> views(model_.views_y * model_.views_x * input.height * input.width);
  E2LF_RETURN_IF_ERROR(engine_.run(input.values, input.height, input.width, views, progress));
  const lightfield::Shape shape{model_.views_y, model_.views_x, images.height, images.width};
  if (input.height != images.height || input.width != images.width) {
    views = crop(views, input, images.height, images.width);
  }
  return lightfield::LightField(shape, std::move(views));
}

}  // namespace e2lf::recon
