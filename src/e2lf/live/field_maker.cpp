// SPDX-License-Identifier: MIT
#include "e2lf/live/field_maker.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::live {

Result<void> FieldMaker::make(const capture::Measurement& measurement, size_t samples, lightfield::LightField& field) {
  const model::Model& model = reconstructor_.model();
  const capture::EventImages& events = measurement.events;
  if (events.transitions + 1 != model.num_patterns || measurement.kind != model.measurement()) {
    return Error{ErrorCode::kShape,
                 cat("a cycle has ", events.transitions, " event images, but ", model.name, " takes ",
                     model.num_patterns - 1, "; use the model that belongs to the patterns"),
                 ""};
  }
  recon::InputConditions conditions{model.camera->constants, {}, samples};
  if (model::is_told_the_camera(model)) {
    conditions.conditioning = capture::conditioning_vector(*model.camera, model.num_patterns, samples);
  }
  E2LF_RETURN_IF_ERROR(
      recon::network_input(measurement, model.input, conditions, model::size_multiple(model.network), input_));
  const lightfield::Shape shape{model.views_y, model.views_x, events.height, events.width};
  if (!(field.shape() == shape)) field = lightfield::LightField(shape);
  const engine::Engine& engine = reconstructor_.engine();
  if (input_.height == shape.height && input_.width == shape.width) {
    return engine.run(input_.values, input_.height, input_.width, field.data());
  }
  uncropped_.resize(shape.num_views() * input_.height * input_.width);
  E2LF_RETURN_IF_ERROR(engine.run(input_.values, input_.height, input_.width, uncropped_));
  for (size_t row = 0; row < shape.num_views() * shape.height; ++row) {
    const size_t view = row / shape.height, y = row % shape.height;
    const float* const from = uncropped_.data() + (view * input_.height + y) * input_.width;
    std::copy_n(from, shape.width, field.data().data() + row * shape.width);
  }
  return {};
}

}  // namespace e2lf::live
