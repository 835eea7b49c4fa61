// SPDX-License-Identifier: MIT
// The task of networks of views.
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/task.h"

namespace e2lf::learn {
namespace {

/// The measurement of light fields [batch, 64, y, x], and their reconstruction.
struct Reconstruction {
  torch::Tensor events;       ///< [batch, transitions, y, x], or [batch, 0, y, x] for a measurement without events
  torch::Tensor light_field;  ///< float32 [batch, 64, y, x]
};

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
  [[nodiscard]] const SampleSource& samples() const override { return batches_; }

  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    const auto origins = input_origins(model, config_.input, config_.patterns.num_patterns);
    return widen_inputs(model.network, model.weights, network_.network(), origins);
  }

  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& codes,
                                      NamedTensors* input_means) override {
    const Batch batch = batches_.at(step, share);
    const auto result = reconstruct(batch, codes, network_.parameters(), input_means);
    // The views are last in memory, so the gradients are, too.
    const auto difference = (result.light_field - batch.light_field).permute({0, 2, 3, 1}).flatten(1);
    const auto errors = difference.square().mean(1);
    return StepLoss{sample_losses(config_.train, errors, batch.gain).mean(), errors.detach().mean()};
  }

  /// The right and lower edges of the scene are cropped to a multiple of 16 px. The noise depends only on
  /// judgement.seed, with which torch's generator is reseeded.
  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const NamedTensors& weights, const torch::Tensor& codes,
                                                         const std::string& name,
                                                         const Judgement& judgement) const override {
    E2LF_ASSIGN_OR_RETURN(const Scene* scene, batches_.dataset().find(name));
    const PatternConfig& patterns = config_.patterns;
    Batch batch;
    batch.constants =
        sample_of(judgement.camera, patterns.num_patterns, patterns.num_codes(), judgement.cycles, device_);
    torch::NoGradGuard no_grad;
    torch::manual_seed(judgement.seed);
    constexpr int64_t kMultiple = 16;
    const auto height = scene->views.size(1) / kMultiple * kMultiple;
    const auto width = scene->views.size(2) / kMultiple * kMultiple;
    batch.light_field = scene->views.slice(1, 0, height).slice(2, 0, width).to(torch::kFloat).div(255.0).unsqueeze(0);
    batch.noise = draw_noise(measurement(), 1, codes.size(0), height, width, device_);
    const auto result = reconstruct(batch, codes, weights, nullptr);
    const auto error = (result.light_field.clamp(0.0, 1.0) - batch.light_field).square_().mean({2, 3});
    return std::vector{SceneScore{scene->name, (-10.0 * error.log10()).mean().item<double>(),
                                  result.events.abs().sum().item<double>() / static_cast<double>(height * width)}};
  }

  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const override {
    model.network = network_.network();
    model.weights = to_weights(weights);
    return model;
  }

 private:
  /// Returns the measurement that the input of the network requires.
  [[nodiscard]] capture::MeasurementKind measurement() const { return model::measurement_of(config_.input).value(); }

  [[nodiscard]] Reconstruction reconstruct(const Batch& batch, const torch::Tensor& codes, const NamedTensors& weights,
                                           NamedTensors* input_means) const {
    const auto [intensities, full] = coded_light(batch.light_field, codes, batch.moving);
    const auto images = measure_images(measurement(), batch.light_field, intensities, config_.sensor.nominal.sigma_i,
                                       batch.noise.image);
    const torch::Tensor& is_pixel = batch.constants.pixel.is_pixel;
    const bool all_pixel = is_pixel.defined() && is_pixel.all().item<bool>();
    auto events = capture::has_events(measurement()) && !all_pixel
                      ? simulate_events(intensities, batch.constants, batch.noise, config_.patterns.event_model)
                      : intensities.slice(1, 0, 0);
    if (is_pixel.defined()) {
      const auto of_pixels = simulate_pixel_events(intensities, full, batch.constants.pixel);
      events =
          all_pixel ? of_pixels : torch::where(is_pixel.to(events.device()).reshape({-1, 1, 1, 1}), of_pixels, events);
    }
    const auto inputs = form_inputs(events, config_.input, batch.constants, images);
    const auto compute = config_.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat;
    return {events, network_.forward(inputs, compute, &weights, input_means)};
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
  if (config.network.gives_disparity() || config.reads_moved_pictures()) {
    return open_any_patterns_task(config, std::move(dataset), device);
  }
#endif
  return open_views_task(config, std::move(dataset), device);
}

void seed_initial_weights(const Config& config) {
  constexpr uint64_t kInitialSeed = 0x1117;
  torch::manual_seed(mix_seed(config.seed, 0, kInitialSeed));
}

}  // namespace e2lf::learn
