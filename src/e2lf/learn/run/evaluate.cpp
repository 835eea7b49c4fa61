// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/evaluate.h"

#include "e2lf/learn/events/event_simulation.h"

namespace e2lf::learn {

Reconstruction reconstruct(const Pipeline& pipeline, const torch::Tensor& light_field, const SampleConstants& constants,
                           const SensorNoise& noise, const MovingSamples& moving) {
  const capture::MeasurementKind kind = pipeline.measurement();
  const auto [intensities, full] = coded_light(light_field, pipeline.codes, moving);
  const auto images = measure_images(kind, light_field, intensities, pipeline.image_sigma, noise.image);
  const torch::Tensor& is_pixel = constants.pixel.is_pixel;
  const bool all_pixel = is_pixel.defined() && is_pixel.all().item<bool>();
  auto events = capture::has_events(kind) && !all_pixel
                    ? simulate_events(intensities, constants, noise, pipeline.event_model)
                    : intensities.slice(1, 0, 0);
  if (is_pixel.defined()) {
    const auto of_pixels = simulate_pixel_events(intensities, full, constants.pixel);
    events =
        all_pixel ? of_pixels : torch::where(is_pixel.to(events.device()).reshape({-1, 1, 1, 1}), of_pixels, events);
  }
  const auto inputs = form_inputs(events, pipeline.input, constants, images);
  return {events, pipeline.network->forward(inputs, pipeline.compute, pipeline.weights, pipeline.input_means)};
}

SceneScore evaluate_scene(const Pipeline& pipeline, const Scene& scene, const SampleConstants& constants,
                          uint64_t seed) {
  torch::NoGradGuard no_grad;
  torch::manual_seed(seed);
  constexpr int64_t kMultiple = 16;
  const auto height = scene.views.size(1) / kMultiple * kMultiple, width = scene.views.size(2) / kMultiple * kMultiple;
  const auto truth = scene.views.slice(1, 0, height).slice(2, 0, width).to(torch::kFloat).div(255.0).unsqueeze(0);
  const auto noise = draw_noise(pipeline.measurement(), 1, pipeline.codes.size(0), height, width, truth.device());
  const auto result = reconstruct(pipeline, truth, constants, noise);
  const auto error = (result.light_field.clamp(0.0, 1.0) - truth).square_().mean({2, 3});
  return {scene.name, (-10.0 * error.log10()).mean().item<double>(),
          result.events.abs().sum().item<double>() / static_cast<double>(height * width)};
}

}  // namespace e2lf::learn
