// SPDX-License-Identifier: MIT
// The task of networks of views.
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/evaluate.h"
#include "e2lf/learn/run/task.h"

namespace e2lf::learn {
namespace {

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
