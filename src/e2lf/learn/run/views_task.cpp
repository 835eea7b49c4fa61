// SPDX-License-Identifier: MIT
// The task of networks of views.
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/task.h"

namespace e2lf::learn {
namespace {

/// The codes, sensor and network that convert a light field to a measurement and reconstruct it.
struct Pipeline {
  const NetworkModule* network = nullptr;
  const NamedTensors* weights = nullptr;
  torch::Tensor codes;  ///< [N, 64]
  EventModel event_model = EventModel::kReferenceAware;
  std::vector<model::InputGroup> input;
  torch::ScalarType compute = torch::kFloat;
  NamedTensors* input_means = nullptr;  ///< see NetworkModule::forward
  double image_sigma = 0.0;             ///< standard deviation of the noise of intensity images

  /// Returns the measurement that `input` requires.
  [[nodiscard]] capture::MeasurementKind measurement() const { return model::measurement_of(input).value(); }
};

/// The measurement of light fields [batch, 64, y, x], and their reconstruction.
struct Reconstruction {
  torch::Tensor events;       ///< [batch, transitions, y, x], or [batch, 0, y, x] for a measurement without events
  torch::Tensor light_field;  ///< float32 [batch, 64, y, x]
};

Reconstruction reconstruct(const Pipeline& pipeline, const torch::Tensor& light_field, const SampleConstants& constants,
                           const SensorNoise& noise, const MovingSamples& moving = {}) {
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

/// Simulates and reconstructs a whole scene with one sample of constants. Its right and lower edges are cropped to a
/// multiple of 16 px. The noise depends only on `seed`, with which torch's generator is reseeded.
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

/// Computes the contribution of each sample to the loss from its mean squared error and its gain.
torch::Tensor sample_losses(const TrainConfig& train, const torch::Tensor& errors, const torch::Tensor& gains) {
  constexpr double kFloor = 1e-6;  // 60 dB; below it, the slope of a power less than 1 would be too large
  const auto relative = errors * gains.pow(-train.gain_weight_power);
  return train.error_power == 1.0 ? relative : (relative + kFloor).pow(train.error_power);
}

class ViewsTask : public Task {
 public:
  ViewsTask(const Config& config, Batches batches, torch::Device device)
      : config_(config), device_(device), batches_(std::move(batches)), network_(make_network(config), device) {}

  [[nodiscard]] const NetworkModule& network() const override { return network_; }
  [[nodiscard]] NamedTensors weights_of_muon() const override { return muon_weights(network_); }
  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_views(); }
  [[nodiscard]] const std::vector<std::string>& validation() const override { return batches_.validation(); }
  [[nodiscard]] const std::optional<capture::SensorProfile>& camera() const override { return batches_.camera(); }

  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    const auto origins = input_origins(model, config_.input, config_.patterns.num_patterns);
    return widen_inputs(model.network, model.weights, network_.network(), origins);
  }

  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& codes,
                                      NamedTensors* input_means) override {
    const Batch batch = batches_.at(step, share);
    Pipeline pipeline = pipeline_with(network_.parameters(), codes);
    pipeline.input_means = input_means;
    const auto result = reconstruct(pipeline, batch.light_field, batch.constants, batch.noise, batch.moving);
    // The views are last in memory, so the gradients are, too.
    const auto difference = (result.light_field - batch.light_field).permute({0, 2, 3, 1}).flatten(1);
    const auto errors = difference.square().mean(1);
    return StepLoss{sample_losses(config_.train, errors, batch.gain).mean(), errors.detach().mean()};
  }

  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const NamedTensors& weights, const torch::Tensor& codes,
                                                         const std::string& scene,
                                                         const Judgement& judgement) const override {
    E2LF_ASSIGN_OR_RETURN(const Scene* found, batches_.dataset().find(scene));
    const PatternConfig& patterns = config_.patterns;
    const auto sample =
        sample_of(judgement.camera, patterns.num_patterns, patterns.num_codes(), judgement.cycles, device_);
    return std::vector{evaluate_scene(pipeline_with(weights, codes), *found, sample, judgement.seed)};
  }

  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const override {
    model.network = network_.network();
    model.weights = to_weights(weights);
    return model;
  }

 private:
  [[nodiscard]] Pipeline pipeline_with(const NamedTensors& weights, const torch::Tensor& codes) const {
    return {.network = &network_,
            .weights = &weights,
            .codes = codes,
            .event_model = config_.patterns.event_model,
            .input = config_.input,
            .compute = config_.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat,
            .image_sigma = config_.sensor.nominal.sigma_i};
  }

  Config config_;
  torch::Device device_;
  Batches batches_;
  NetworkModule network_;
};

}  // namespace

Result<std::unique_ptr<Task>> open_views_task(const Config& config, Dataset dataset, torch::Device device) {
  E2LF_ASSIGN_OR_RETURN(auto batches, Batches::create(config, std::move(dataset), device));
  seed_initial_weights(config);
  return std::unique_ptr<Task>(std::make_unique<ViewsTask>(config, std::move(batches), device));
}

Result<std::unique_ptr<Task>> open_task(Config& config, torch::Device device) {
  E2LF_ASSIGN_OR_RETURN(auto dataset, read_dataset(config.data.file, device));
#if E2LF_LEARN_KERNELS
  if (config.network.gives_disparity()) return open_depth_task(config, std::move(dataset), device);
  if (config.network.gives_picture()) return open_picture_task(config, std::move(dataset), device);
#endif
  return open_views_task(config, std::move(dataset), device);
}

void seed_initial_weights(const Config& config) {
  constexpr uint64_t kInitialSeed = 0x1117;
  torch::manual_seed(mix_seed(config.seed, 0, kInitialSeed));
}

}  // namespace e2lf::learn
