// SPDX-License-Identifier: MIT
// The task of networks of disparity for any patterns.
#include "e2lf/learn/run/depth_task.h"

#include <algorithm>
#include <filesystem>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/data/pattern_sets.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

constexpr int64_t kUnjudgedBorder = 15;  // px

/// A set of patterns with which a network is judged, and its name, which is empty for patterns.codes.
struct JudgedSet {
  std::string name;
  capture::Codes codes;
};

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
    model::Weights weights = model.weights;
    for (const auto& [name, shared] : model.any_patterns) weights[name] = shared.values;
    return weights;
  }

  /// Fails if patterns are drawn that cannot be described.
  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& /*codes*/,
                                      NamedTensors* input_means) override {
    const DepthBatch batch = batches_.at(step, share);
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures(batch.codes, device_));
    const DepthInputs inputs = inputs_of(batch.events, batch.constants, batch.cycles);
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
    std::vector<SceneScore> scores;
    for (const JudgedSet& set : judged_) {
      E2LF_ASSIGN_OR_RETURN(SceneScore score, evaluate_set(weights, set.codes, *found, judgement));
      if (!set.name.empty()) score.name += ":" + set.name;
      scores.push_back(std::move(score));
    }
    return scores;
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
  [[nodiscard]] DepthInputs inputs_of(const torch::Tensor& events, const SampleConstants& constants,
                                      const torch::Tensor& cycles) const {
    const std::vector<model::InputGroup> groups(config_.input.begin(), config_.input.end() - 1);  // without the camera
    const float of_camera = config_.input.back().scale;
    return {form_inputs(events, groups, constants).unflatten(1, {static_cast<int64_t>(groups.size()), -1}),
            constants.conditioning * of_camera, torch::log2(cycles) * (capture::cycles_condition(2) * of_camera)};
  }

  /// Evaluates one set of patterns. Mirror images continue the pictures to a size that the network takes.
  [[nodiscard]] Result<SceneScore> evaluate_set(const NamedTensors& weights, const capture::Codes& codes,
                                                const Scene& scene, const Judgement& judgement) const {
    torch::NoGradGuard no_grad;
    torch::manual_seed(judgement.seed);
    const int64_t multiple = int64_t{2} << (config_.network.widths.size() - 1);
    const int64_t height = scene.views.size(1), width = scene.views.size(2);
    if (2 * std::min(height, width) <= multiple) {
      return fail(ErrorCode::kShape, scene.name,
                  "the scene is too small for this network; evaluate scenes of more than ", multiple / 2, " px");
    }
    const auto missing = [&](int64_t length) { return (multiple - length % multiple) % multiple; };
    const auto views = at::reflection_pad2d(scene.views.to(torch::kFloat).div(255.0).unsqueeze(0).contiguous(),
                                            {0, missing(width), 0, missing(height)});
    const PatternNumbers numbers = numbers_of(codes);
    const auto sample = sample_of(judgement.camera, numbers.all, numbers.codes, 1, device_);
    const auto count = torch::full({1, views.size(2), views.size(3)}, static_cast<double>(judgement.cycles),
                                   torch::device(device_).dtype(torch::kFloat));
    const auto events = simulate_cycles(views, {codes}, sample, torch::zeros({1}, torch::device(device_)), count);
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures({codes}, device_));
    // Half precision would be pessimistic.
    const auto output = network_.forward(inputs_of(events, sample, count), apertures, torch::kFloat, &weights);
    const auto error = (output[0][0].narrow(0, 0, height).narrow(1, 0, width) - scene.disparity[3]).abs();
    const int64_t border = std::min({kUnjudgedBorder, error.size(0) / 4, error.size(1) / 4});
    const auto judged = error.slice(0, border, error.size(0) - border).slice(1, border, error.size(1) - border);
    const double off = (judged > kWrongDisparity).sum().item<double>(), known = judged.isfinite().sum().item<double>();
    return SceneScore{scene.name, 100 * off / std::max(known, 1.0),
                      events.abs().sum().item<double>() / static_cast<double>(views.size(2) * views.size(3))};
  }

  Config config_;
  DepthBatches batches_;
  AnyPatternsModule network_;
  capture::Codes codes_;
  std::vector<JudgedSet> judged_;
  torch::ScalarType compute_;
  torch::Device device_;
};

/// Reads a set of patterns as the display shows it: whole cycles if patterns.whole_cycle is set.
Result<capture::Codes> read_shown(const std::string& name, const PatternConfig& patterns) {
  E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_pattern_set(name));
  if (patterns.whole_cycle && !capture::codes_of_whole_cycle(codes)) codes = capture::whole_cycle(codes);
  E2LF_RETURN_IF_ERROR(describe_apertures({codes}, torch::kCPU));
  return codes;
}

/// Reads the patterns that a network of disparity is judged with: those of patterns.evaluated, or else its own.
Result<std::vector<JudgedSet>> read_judged(const PatternConfig& patterns, const capture::Codes& own) {
  if (patterns.evaluated.empty()) return std::vector{JudgedSet{"", own}};
  std::vector<JudgedSet> sets;
  for (const std::string& name : patterns.evaluated) {
    E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_shown(name, patterns));
    sets.push_back({std::filesystem::path(name).stem().string(), std::move(codes)});
  }
  return sets;
}

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
