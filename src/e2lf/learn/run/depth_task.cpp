// SPDX-License-Identifier: MIT
// The task of networks of disparity for any patterns.
#include <algorithm>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/judged_scenes.h"
#include "e2lf/learn/run/task.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

class DepthTask : public Task {
 public:
  DepthTask(const Config& config, DepthBatches batches, capture::Codes codes, std::vector<JudgedSet> judged,
            torch::Device device)
      : config_(config),
        batches_(std::move(batches)),
        network_(config.network.widths, device),
        codes_(std::move(codes)),
        judged_(std::move(judged)),
        compute_(config.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat),
        device_(device) {}

  [[nodiscard]] const NetworkModule& network() const override { return network_.module(); }
  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_disparity(); }
  [[nodiscard]] const std::vector<std::string>& validation() const override { return batches_.validation(); }
  [[nodiscard]] const std::optional<capture::SensorProfile>& camera() const override { return batches_.camera(); }

  /// The layers with few outputs are left to Adam.
  [[nodiscard]] NamedTensors weights_of_muon() const override {
    NamedTensors weights = muon_weights(network());
    for (const char* layer : {"pictures", "features", "head"}) weights.erase(cat(layer, ".weight"));
    return weights;
  }

  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    if (!model::is_for_any_patterns(model)) {
      return fail(ErrorCode::kInvalidValue, "",
                  "this is no network of disparity for any patterns; start from one, such as e2lf-depth");
    }
    return weights_for_any_patterns(model);
  }

  /// Fails if patterns are drawn that cannot be described.
  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& /*codes*/,
                                      NamedTensors* input_means) override {
    const DepthBatch batch = batches_.at(step, share);
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures(batch.codes, device_));
    const DepthInputs inputs = form_depth_inputs(batch.events, batch.constants, batch.cycles, config_.input);
    return depth_loss(network_.forward(inputs, apertures, compute_, nullptr, input_means), batch.disparity);
  }

  /// Scores are the shares of disparities that are wrong, in %, without a border of 15 px.
  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const NamedTensors& weights, const torch::Tensor& /*codes*/,
                                                         const std::string& scene,
                                                         const Judgement& judgement) const override {
    E2LF_ASSIGN_OR_RETURN(const Scene* found, batches_.dataset().find(scene));
    if (!found->disparity.defined() || !found->disparity[3].isfinite().any().item<bool>()) {
      return fail(ErrorCode::kNotFound, scene,
                  "the disparity of view (4, 4) of this scene is not known; pack it with `e2lf pack --disparity`, or "
                  "name another scene");
    }
    return judge_sets(judged_, [&](const auto& codes) { return evaluate_set(weights, codes, *found, judgement); });
  }

  /// Adapts the weights to patterns.codes, at two scales. Fails as geometry::for_patterns() does.
  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const override {
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

 private:
  [[nodiscard]] Result<SceneScore> evaluate_set(const NamedTensors& weights, const capture::Codes& codes,
                                                const Scene& scene, const Judgement& judgement) const {
    torch::NoGradGuard no_grad;
    const int64_t multiple = int64_t{2} << (config_.network.widths.size() - 1);
    E2LF_ASSIGN_OR_RETURN(const JudgedEvents judged, simulate_judged(scene, codes, judgement, multiple, device_));
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures({codes}, device_));
    const auto inputs = form_depth_inputs(judged.events, judged.constants, judged.cycles, config_.input);
    // Half precision would be pessimistic.
    const auto output = network_.forward(inputs, apertures, torch::kFloat, &weights);
    const auto error = (judged_part(output[0][0], scene) - judged_part(scene.disparity[3], scene)).abs();
    const double off = (error > kWrongDisparity).sum().item<double>(), known = error.isfinite().sum().item<double>();
    return SceneScore{scene.name, 100 * off / std::max(known, 1.0), judged.events_per_pixel};
  }

  Config config_;
  DepthBatches batches_;
  AnyPatternsModule network_;
  capture::Codes codes_;
  std::vector<JudgedSet> judged_;
  torch::ScalarType compute_;
  torch::Device device_;
};

}  // namespace

StepLoss depth_loss(const torch::Tensor& output, const torch::Tensor& disparity) {
  constexpr double kMostLogScale = 4, kPlainShare = 0.05, kBoundedShare = 0.5;
  const auto known = disparity.isfinite();
  const auto error = (output.select(1, 0) - torch::where(known, disparity, torch::zeros_like(disparity))).abs();
  const auto log_scale = output.select(1, 1).clamp(-kMostLogScale, kMostLogScale);
  const auto each = error * torch::exp(-log_scale) + log_scale + kPlainShare * error +
                    kBoundedShare * error / (error + kWrongDisparity);
  const auto share = known.to(torch::kFloat) / known.sum().clamp_min(1);
  return {(each * share).sum(), ((error.detach() > kWrongDisparity) * share).sum()};
}

Result<std::unique_ptr<Task>> open_depth_task(Config& config, Dataset dataset, torch::Device device) {
  PatternConfig& patterns = config.patterns;
  E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_shown(patterns.codes, patterns));
  patterns.num_patterns = codes.num_patterns;
  E2LF_ASSIGN_OR_RETURN(auto judged, read_judged(patterns, codes));
  E2LF_ASSIGN_OR_RETURN(auto batches, DepthBatches::create(config, codes, std::move(dataset), device));
  seed_initial_weights(config);
  return std::unique_ptr<Task>(
      std::make_unique<DepthTask>(config, std::move(batches), std::move(codes), std::move(judged), device));
}

}  // namespace e2lf::learn
