// SPDX-License-Identifier: MIT
// What the tasks for any patterns share, and that of networks of disparity on events.
#include "e2lf/learn/run/any_patterns_task.h"

#include <algorithm>
#include <filesystem>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

/// Reads a set of patterns as the display shows it: whole cycles if patterns.whole_cycle is set. Fails as
/// read_pattern_set() and describe_apertures() do.
Result<capture::Codes> read_shown(const std::string& name, const PatternConfig& patterns) {
  E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_pattern_set(name));
  if (patterns.whole_cycle && !capture::codes_of_whole_cycle(codes)) codes = capture::whole_cycle(codes);
  E2LF_RETURN_IF_ERROR(describe_apertures({codes}, torch::kCPU));
  return codes;
}

/// Reads the patterns that a network is judged with: those of patterns.evaluated, or else `own`.
Result<std::vector<JudgedSet>> read_judged(const PatternConfig& patterns, const capture::Codes& own) {
  if (patterns.evaluated.empty()) return std::vector{JudgedSet{"", own}};
  std::vector<JudgedSet> sets;
  for (const std::string& name : patterns.evaluated) {
    E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_shown(name, patterns));
    sets.push_back({std::filesystem::path(name).stem().string(), std::move(codes)});
  }
  return sets;
}

/// Simulates the events of a scene. The size becomes a multiple of `multiple`. Fails with kShape if the scene is too
/// small for it.
Result<JudgedEvents> simulate_judged(const Scene& scene, const capture::Codes& codes, const Judgement& judgement,
                                     int64_t multiple, torch::Device device) {
  torch::NoGradGuard no_grad;
  torch::manual_seed(judgement.seed);
  const int64_t height = scene.views.size(1), width = scene.views.size(2);
  if (2 * std::min(height, width) <= multiple) {
    return fail(ErrorCode::kShape, scene.name, "the scene is too small for this network; evaluate scenes of more than ",
                multiple / 2, " px");
  }
  const auto missing = [&](int64_t length) { return (multiple - length % multiple) % multiple; };
  const auto views = at::reflection_pad2d(scene.views.to(torch::kFloat).div(255.0).unsqueeze(0).contiguous(),
                                          {0, missing(width), 0, missing(height)});
  const PatternNumbers numbers = numbers_of(codes);
  JudgedEvents judged;
  judged.constants = sample_of(judgement.camera, numbers.all, numbers.codes, 1, device);
  judged.cycles = torch::full({1, views.size(2), views.size(3)}, static_cast<double>(judgement.cycles),
                              torch::device(device).dtype(torch::kFloat));
  judged.events =
      simulate_cycles(views, {codes}, judged.constants, torch::zeros({1}, torch::device(device)), judged.cycles);
  judged.events_per_pixel =
      judged.events.abs().sum().item<double>() / static_cast<double>(views.size(2) * views.size(3));
  return judged;
}

/// Scores are wrong_disparities().
class DepthTask : public AnyPatternsTask {
 public:
  DepthTask(const Config& config, DepthBatches batches, const capture::Codes& codes, std::vector<JudgedSet> judged,
            torch::Device device)
      : AnyPatternsTask(config, std::move(batches), std::move(judged), device),
        network_(config.network.widths, device),
        codes_(codes) {}

  [[nodiscard]] const NetworkModule& network() const override { return network_.module(); }
  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_disparity(); }

  [[nodiscard]] NamedTensors weights_of_muon() const override { return disparity_weights_of_muon(network()); }

  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    if (model.any_patterns.empty()) {
      return fail(ErrorCode::kInvalidValue, "",
                  "this is no network of disparity for any patterns that reads events; start from one, such as "
                  "e2lf-depth-first");
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

  /// Adapts the weights to patterns.codes, at two scales. Fails as geometry::for_patterns() does.
  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const override {
    model.network = make_network(config_);
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
  [[nodiscard]] int64_t multiple() const override { return scale_of_last_level(config_.network.widths); }

  [[nodiscard]] Result<void> check_scene(const Scene& scene) const override { return check_disparity(scene); }

  [[nodiscard]] Result<double> judge(const NamedTensors& weights, const capture::Codes& codes, const Scene& scene,
                                     const JudgedEvents& judged) const override {
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures({codes}, device_));
    const auto inputs = form_depth_inputs(judged.events, judged.constants, judged.cycles, config_.input);
    // Half precision would be pessimistic.
    return wrong_disparities(network_.forward(inputs, apertures, torch::kFloat, &weights)[0][0], scene);
  }

  AnyPatternsModule network_;
  capture::Codes codes_;
};

}  // namespace

torch::Tensor judged_part(const torch::Tensor& map, const Scene& scene) {
  constexpr int64_t kUnjudgedBorder = 15;  // px
  const int64_t height = scene.views.size(1), width = scene.views.size(2);
  const int64_t border = std::min({kUnjudgedBorder, height / 4, width / 4});
  return map.slice(0, border, height - border).slice(1, border, width - border);
}

Result<void> check_disparity(const Scene& scene) {
  if (scene.disparity.defined() && scene.disparity[3].isfinite().any().item<bool>()) return {};
  return fail(ErrorCode::kNotFound, scene.name,
              "the disparity of view (4, 4) of this scene is not known; pack it with `e2lf pack --disparity`, or "
              "name another scene");
}

double wrong_disparities(const torch::Tensor& disparity, const Scene& scene) {
  const auto error = (judged_part(disparity, scene) - judged_part(scene.disparity[3], scene)).abs();
  const double off = (error > kWrongDisparity).sum().item<double>(), known = error.isfinite().sum().item<double>();
  return 100 * off / std::max(known, 1.0);
}

NamedTensors disparity_weights_of_muon(const NetworkModule& network) {
  NamedTensors weights = muon_weights(network);
  for (const char* layer : {"pictures", "features", "head"}) weights.erase(cat(layer, ".weight"));
  return weights;
}

int64_t scale_of_last_level(const std::vector<size_t>& widths) {
  return int64_t{2} << (widths.size() - 1);
}

Result<std::vector<SceneScore>> AnyPatternsTask::evaluate(const NamedTensors& weights, const torch::Tensor& /*codes*/,
                                                          const std::string& name, const Judgement& judgement) const {
  torch::NoGradGuard no_grad;
  E2LF_ASSIGN_OR_RETURN(const Scene* scene, batches_.dataset().find(name));
  E2LF_RETURN_IF_ERROR(check_scene(*scene));
  std::vector<SceneScore> scores;
  for (const JudgedSet& set : judged_) {
    E2LF_ASSIGN_OR_RETURN(const JudgedEvents events,
                          simulate_judged(*scene, set.codes, judgement, multiple(), device_));
    E2LF_ASSIGN_OR_RETURN(const double score, judge(weights, set.codes, *scene, events));
    scores.push_back({set.name.empty() ? name : cat(name, ":", set.name), score, events.events_per_pixel});
  }
  return scores;
}

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

Result<std::unique_ptr<Task>> open_any_patterns_task(Config& config, Dataset dataset, torch::Device device) {
  PatternConfig& patterns = config.patterns;
  E2LF_ASSIGN_OR_RETURN(const capture::Codes codes, read_shown(patterns.codes, patterns));
  const bool reads_moved_pictures = config.reads_moved_pictures();
  if (reads_moved_pictures) E2LF_RETURN_IF_ERROR(geometry::moved_input(codes, {}));
  patterns.num_patterns = codes.num_patterns;
  E2LF_ASSIGN_OR_RETURN(auto judged, read_judged(patterns, codes));
  E2LF_ASSIGN_OR_RETURN(auto batches, DepthBatches::create(config, codes, std::move(dataset), device));
  seed_initial_weights(config);
  if (reads_moved_pictures) {
    return open_moved_pictures_task(config, std::move(batches), std::move(judged), device);
  }
  return std::unique_ptr<Task>(
      std::make_unique<DepthTask>(config, std::move(batches), codes, std::move(judged), device));
}

}  // namespace e2lf::learn
