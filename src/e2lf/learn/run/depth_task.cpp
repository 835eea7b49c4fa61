// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/depth_task.h"

#include <algorithm>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

constexpr uint64_t kKnownValidation = 21;  // purpose of a seed
constexpr int64_t kUnjudgedBorder = 15;    // px

}  // namespace

DepthLoss depth_loss(const torch::Tensor& output, const torch::Tensor& disparity) {
  constexpr double kMostLogScale = 4, kPlainShare = 0.05, kBoundedShare = 0.5;
  const auto error = (output.select(1, 0) - disparity).abs();
  const auto log_scale = output.select(1, 1).clamp(-kMostLogScale, kMostLogScale);
  const auto each = error * torch::exp(-log_scale) + log_scale + kPlainShare * error +
                    kBoundedShare * error / (error + kWrongDisparity);
  return {each.mean(), (error.detach() > kWrongDisparity).to(torch::kFloat).mean()};
}

DepthTask::DepthTask(const Config& config, const Dataset& dataset, std::vector<capture::Codes> known,
                     capture::Codes codes, const std::optional<capture::SensorProfile>& camera, torch::Device device)
    : config_(config),
      batches_(config, dataset, std::move(known), camera, device),
      network_(config.network.widths, device),
      codes_(std::move(codes)),
      compute_(config.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat),
      device_(device) {}

DepthInputs DepthTask::inputs_of(const torch::Tensor& events, const SampleConstants& constants,
                                 const torch::Tensor& cycles) const {
  const std::vector<model::InputGroup> groups(config_.input.begin(), config_.input.end() - 1);  // without the camera
  const float of_camera = config_.input.back().scale;
  return {form_inputs(events, groups, constants).unflatten(1, {static_cast<int64_t>(groups.size()), -1}),
          constants.conditioning * of_camera, torch::log2(cycles) * (capture::cycles_condition(2) * of_camera)};
}

Result<DepthLoss> DepthTask::loss(uint64_t step, Share share, NamedTensors* input_means) {
  const DepthBatch batch = batches_.at(step, share);
  E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures(batch.codes, device_));
  const DepthInputs inputs = inputs_of(batch.events, batch.constants, batch.cycles);
  return depth_loss(network_.forward(inputs, apertures, compute_, nullptr, input_means), batch.disparity);
}

Result<SceneScore> DepthTask::evaluate(const NamedTensors& weights, const Scene& scene,
                                       const capture::SensorProfile& camera, size_t cycles, uint64_t seed) const {
  if (!scene.disparity.defined()) {
    return fail(ErrorCode::kNotFound, scene.name, "the disparity of this scene is not known; name another scene");
  }
  torch::NoGradGuard no_grad;
  torch::manual_seed(seed);
  const int64_t multiple = int64_t{2} << (config_.network.widths.size() - 1);
  const auto crop = [&](const torch::Tensor& x) {
    return x.narrow(-2, 0, x.size(-2) / multiple * multiple).narrow(-1, 0, x.size(-1) / multiple * multiple);
  };
  const auto views = crop(scene.views).to(torch::kFloat).div(255.0).unsqueeze(0).contiguous();
  const size_t number = codes_.num_patterns;
  const auto sample = sample_of(camera, number, number, 1, device_);
  const auto count = torch::full({1, views.size(2), views.size(3)}, static_cast<double>(cycles),
                                 torch::device(device_).dtype(torch::kFloat));
  const auto events = simulate_cycles(views, {codes_}, sample, torch::zeros({1}, torch::device(device_)), count);
  E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures({codes_}, device_));
  // Half precision would be pessimistic.
  const auto output = network_.forward(inputs_of(events, sample, count), apertures, torch::kFloat, &weights);
  const auto error = (output[0][0] - crop(scene.disparity)).abs();
  const int64_t border = std::min({kUnjudgedBorder, error.size(0) / 4, error.size(1) / 4});
  const auto judged = error.slice(0, border, error.size(0) - border).slice(1, border, error.size(1) - border);
  return SceneScore{scene.name, 100 * (judged > kWrongDisparity).to(torch::kFloat).mean().item<double>(),
                    events.abs().sum().item<double>() / static_cast<double>(views.size(2) * views.size(3))};
}

Result<model::Model> DepthTask::complete(model::Model model, const NamedTensors& weights) const {
  model.network = depth_network(config_.network.widths, model::num_input_channels(model.input, codes_.num_patterns));
  model.weights.clear();
  for (const auto& tensor : model::weight_shapes(model.network)) {
    model.weights[tensor.name] = std::vector<float>(tensor.size());  // of layers that are adapted to the patterns
  }
  AnyPatternsModule::store(weights, model);
  E2LF_ASSIGN_OR_RETURN(
      model, model::at_two_scales(std::move(model), static_cast<float>(config_.network.share_of_full_scale)));
  return geometry::for_patterns(model, codes_);
}

std::vector<std::string> add_known_scenes(const Config& config, torch::Device device, Dataset& dataset) {
  constexpr uint64_t kScenes = 2;
  std::vector<std::string> names;
  for (uint64_t i = 1; i <= kScenes; ++i) {
    const KnownScene scene =
        synthesise_known(dataset.textures, config.data.synthesiser, mix_seed(config.seed, kKnownValidation, i), device);
    names.push_back(cat("synthesised ", i));
    dataset.scenes.push_back({names.back(), views_last(scene.views), scene.disparity[3].contiguous()});
  }
  return names;
}

}  // namespace e2lf::learn
