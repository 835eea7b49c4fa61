// SPDX-License-Identifier: MIT
// The tasks of networks for any patterns: of disparity, and of views on moved pictures.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/task.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

/// A set of patterns with which a network is judged, and its name, which is empty for patterns.codes.
struct JudgedSet {
  std::string name;
  capture::Codes codes;
};

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

/// The events of one scene as a batch, continued by mirror images to a size that networks take.
struct JudgedEvents {
  torch::Tensor events, cycles;  ///< as those of DepthBatch
  SampleConstants constants;
  double events_per_pixel = 0;
};

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

/// Takes of a map [y, x] of a judged scene what is inside of the scene and of a border of 15 px.
torch::Tensor judged_part(const torch::Tensor& map, const Scene& scene) {
  constexpr int64_t kUnjudgedBorder = 15;  // px
  const int64_t height = scene.views.size(1), width = scene.views.size(2);
  const int64_t border = std::min({kUnjudgedBorder, height / 4, width / 4});
  return map.slice(0, border, height - border).slice(1, border, width - border);
}

/// A task whose samples each have patterns of their own, and whose scenes are judged with several sets of patterns.
class AnyPatternsTask : public Task {
 public:
  AnyPatternsTask(const Config& config, DepthBatches batches, std::vector<JudgedSet> judged, torch::Device device)
      : config_(config),
        batches_(std::move(batches)),
        compute_(config.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat),
        device_(device),
        judged_(std::move(judged)) {}

  [[nodiscard]] const SampleSource& samples() const override { return batches_; }

  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const NamedTensors& weights, const torch::Tensor& /*codes*/,
                                                         const std::string& name,
                                                         const Judgement& judgement) const override {
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

 protected:
  /// Returns the number of pixels of which height and width of a scene are made multiples.
  [[nodiscard]] virtual int64_t multiple() const = 0;

  /// Checks that a scene has what it is judged by.
  [[nodiscard]] virtual Result<void> check_scene(const Scene& /*scene*/) const { return {}; }

  /// Returns the score of weights on the events of a scene.
  [[nodiscard]] virtual Result<double> judge(const NamedTensors& weights, const capture::Codes& codes,
                                             const Scene& scene, const JudgedEvents& judged) const = 0;

  Config config_;
  DepthBatches batches_;
  torch::ScalarType compute_;
  torch::Device device_;

 private:
  std::vector<JudgedSet> judged_;
};

int64_t scale_of_last_level(const std::vector<size_t>& widths) {
  return int64_t{2} << (widths.size() - 1);
}

/// Scores are the shares of disparities that are wrong, in %, without a border of 15 px.
class DepthTask : public AnyPatternsTask {
 public:
  DepthTask(const Config& config, DepthBatches batches, const capture::Codes& codes, std::vector<JudgedSet> judged,
            torch::Device device)
      : AnyPatternsTask(config, std::move(batches), std::move(judged), device),
        network_(config.network.widths, device),
        codes_(codes) {}

  [[nodiscard]] const NetworkModule& network() const override { return network_.module(); }
  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_disparity(); }

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
  [[nodiscard]] int64_t multiple() const override { return scale_of_last_level(config_.network.widths); }

  [[nodiscard]] Result<void> check_scene(const Scene& scene) const override {
    if (scene.disparity.defined() && scene.disparity[3].isfinite().any().item<bool>()) return {};
    return fail(ErrorCode::kNotFound, scene.name,
                "the disparity of view (4, 4) of this scene is not known; pack it with `e2lf pack --disparity`, or "
                "name another scene");
  }

  [[nodiscard]] Result<double> judge(const NamedTensors& weights, const capture::Codes& codes, const Scene& scene,
                                     const JudgedEvents& judged) const override {
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures({codes}, device_));
    const auto inputs = form_depth_inputs(judged.events, judged.constants, judged.cycles, config_.input);
    // Half precision would be pessimistic.
    const auto output = network_.forward(inputs, apertures, torch::kFloat, &weights);
    const auto error = (judged_part(output[0][0], scene) - judged_part(scene.disparity[3], scene)).abs();
    const double off = (error > kWrongDisparity).sum().item<double>(), known = error.isfinite().sum().item<double>();
    return 100 * off / std::max(known, 1.0);
  }

  AnyPatternsModule network_;
  capture::Codes codes_;
};

/// A network of disparity for any patterns that stays as it is, with the input groups and the number of levels that its
/// file states.
struct FixedDisparity {
  std::string name;
  std::vector<model::InputGroup> input;
  AnyPatternsModule network;
  int64_t multiple = 1;  ///< of the height and width
};

/// Scores are the PSNR of all views without a border of 15 px.
class MovedViewsTask : public AnyPatternsTask {
 public:
  MovedViewsTask(const Config& config, DepthBatches batches, std::vector<JudgedSet> judged, FixedDisparity disparity,
                 torch::Device device)
      : AnyPatternsTask(config, std::move(batches), std::move(judged), device),
        disparity_(std::move(disparity)),
        network_(make_network(config), device) {}

  [[nodiscard]] const NetworkModule& network() const override { return network_; }
  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_views(); }
  [[nodiscard]] NamedTensors weights_of_muon() const override { return muon_weights(network_); }

  /// The first planes are the inputs of a network for the patterns of e2lf-n4 that is conditioned on the sensor, so
  /// that it can be the start, too.
  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    if (model::reads_moved_pictures(model)) return model.weights;
    constexpr model::InputKind kOnEvents[] = {model::InputKind::kCounts, model::InputKind::kCumulative,
                                              model::InputKind::kIntensity, model::InputKind::kCamera};
    const size_t known = model.network.input_channels;
    if (std::ranges::equal(model.input, kOnEvents, {}, &model::InputGroup::kind) && model.num_patterns == 4) {
      auto with_more = with_unused_inputs(model.network, model.weights, known, model::kMovedPlanes - known);
      if (with_more) return std::move(with_more->weights);
    }
    return fail(ErrorCode::kInvalidValue, "",
                "this network reads neither moved pictures nor the events and the sensor of four patterns; start from "
                "e2lf-any or e2lf-n4-camera");
  }

  /// The loss is the mean logarithm of the squared errors of the samples, so that each counts by its decibels.
  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& /*codes*/,
                                      NamedTensors* input_means) override {
    constexpr double kFloor = 1e-5;  // 50 dB
    constexpr int64_t kBorder = 8;   // px
    const DepthBatch batch = batches_.at(step, share);
    E2LF_ASSIGN_OR_RETURN(const auto planes,
                          planes_of(batch.events, batch.constants, batch.cycles, batch.codes, compute_));
    const auto [patches, truth] = random_patches(planes, batch.views, step, share);
    const auto views = network_.forward(patches, compute_, nullptr, input_means);
    const auto inside = torch::indexing::Slice(kBorder, -kBorder), all = torch::indexing::Slice();
    const auto errors = ((views - truth) / batch.gain.reshape({-1, 1, 1, 1}))
                            .index({all, all, inside, inside})
                            .square()
                            .mean({1, 2, 3});
    return StepLoss{torch::log(errors + kFloor).mean(), errors.detach().mean()};
  }

  /// The model names its network of disparity, and has no patterns of its own.
  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const override {
    model.codes.reset();
    model.network = network_.network();
    model.weights = to_weights(weights);
    model::OpenGuide guide;
    guide.guide.disparity = disparity_.name;
    model.open_guide = std::make_shared<const model::OpenGuide>(std::move(guide));
    return model;
  }

 private:
  [[nodiscard]] int64_t multiple() const override { return disparity_.multiple; }

  [[nodiscard]] Result<double> judge(const NamedTensors& weights, const capture::Codes& codes, const Scene& scene,
                                     const JudgedEvents& judged) const override {
    E2LF_ASSIGN_OR_RETURN(const auto planes,
                          planes_of(judged.events, judged.constants, judged.cycles, {codes}, torch::kFloat));
    const auto views = network_.forward(planes, torch::kFloat, &weights)[0].clamp(0.0, 1.0);
    double squares = 0;
    for (int64_t view = 0; view < views.size(0); ++view) {
      const auto truth = scene.views[view].to(torch::kFloat) / 255.0;
      squares += (judged_part(views[view], scene) - judged_part(truth, scene)).square().mean().item<double>();
    }
    return -10 * std::log10(squares / static_cast<double>(views.size(0)) + 1e-12);
  }

  /// Cuts a patch out of each sample, of the planes and of the views. Those of a sample do not depend on the number of
  /// shares.
  [[nodiscard]] std::pair<torch::Tensor, torch::Tensor> random_patches(const torch::Tensor& planes,
                                                                       const torch::Tensor& views, uint64_t step,
                                                                       Share share) const {
    constexpr uint64_t kPatchPlaces = 14;
    Draws draws(mix_seed(config_.seed, kPatchPlaces, step), 0);
    const auto size = static_cast<int64_t>(config_.train.patch);
    const auto places = static_cast<uint64_t>(planes.size(2) - size + 1);
    std::vector<torch::Tensor> patches, truths;
    const int64_t first = share.rank * planes.size(0);
    for (int64_t i = -first; i < planes.size(0); ++i) {
      const auto y = static_cast<int64_t>(draws.below(places)), x = static_cast<int64_t>(draws.below(places));
      if (i < 0) continue;  // of another share
      patches.push_back(planes[i].narrow(1, y, size).narrow(2, x, size));
      truths.push_back(views[i].narrow(1, y, size).narrow(2, x, size));
    }
    return {torch::stack(patches), torch::stack(truths)};
  }

  /// Moves the pictures of a batch by the fixed network.
  [[nodiscard]] Result<torch::Tensor> planes_of(const torch::Tensor& events, const SampleConstants& constants,
                                                const torch::Tensor& cycles, const std::vector<capture::Codes>& codes,
                                                torch::ScalarType compute) const {
    torch::NoGradGuard no_grad;
    std::vector<model::MovedInput> patterns;
    for (const capture::Codes& each : codes) {
      E2LF_ASSIGN_OR_RETURN(patterns.emplace_back(), geometry::moved_input(each, disparity_.input));
    }
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures(codes, device_));
    const DepthInputs inputs = form_depth_inputs(events, constants, cycles, disparity_.input);
    return moved_planes(inputs, disparity_.network.forward(inputs, apertures, compute), patterns);
  }

  FixedDisparity disparity_;
  NetworkModule network_;
};

/// Returns the widths of the levels of a network of disparity.
std::vector<size_t> widths_of(const model::Network& network) {
  std::vector<size_t> widths;
  const auto add = [&](const std::string& name) {
    const auto layer = std::ranges::find(network.layers, name, &model::Layer::name);
    if (layer != network.layers.end()) widths.push_back(layer->out_channels);
    return layer != network.layers.end();
  };
  for (bool found = add("stem"); found;) found = add(cat("down", widths.size() - 1, "_half"));
  return widths;
}

Result<FixedDisparity> read_disparity(const Config& config, torch::Device device) {
  const std::string& name = config.network.disparity;
  geometry::add_operations();  // before a model with them is read
  E2LF_ASSIGN_OR_RETURN(const auto path, find_file_or_bundled(kBundledModels, name));
  E2LF_ASSIGN_OR_RETURN(const model::Model model, model::read_model(path));
  const auto bundled = bundled_file_named(kBundledModels, path.stem().string());
  std::error_code error;
  if (bundled && !std::filesystem::equivalent(*bundled, path, error)) {
    return fail(ErrorCode::kInvalidValue, "network.disparity", name,
                " has the name of a bundled model, which would be found in its place; rename the file");
  }
  const std::vector<size_t> widths = widths_of(model.network);
  if (model.any_patterns.empty() || !model::is_depth_network(model) || widths.size() < 2) {
    return fail(ErrorCode::kInvalidValue, "network.disparity", name,
                " is no network of disparity for any patterns; name one, such as e2lf-depth");
  }
  FixedDisparity result{path.stem().string(), model.input, AnyPatternsModule(widths, device),
                        scale_of_last_level(widths)};
  if (config.data.synthesiser.size % result.multiple != 0) {
    return fail(ErrorCode::kInvalidValue, "data.synthesiser.size", name, " takes multiples of ", result.multiple,
                " px; set it to one");
  }
  E2LF_RETURN_IF_ERROR(load_weights(result.network.module().parameters(), weights_for_any_patterns(model), name));
  return result;
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

Result<std::unique_ptr<Task>> open_any_patterns_task(Config& config, Dataset dataset, torch::Device device) {
  PatternConfig& patterns = config.patterns;
  E2LF_ASSIGN_OR_RETURN(const capture::Codes codes, read_shown(patterns.codes, patterns));
  const bool reads_moved_pictures = config.reads_moved_pictures();
  if (reads_moved_pictures) E2LF_RETURN_IF_ERROR(geometry::moved_input(codes, {}));
  patterns.num_patterns = codes.num_patterns;
  E2LF_ASSIGN_OR_RETURN(auto judged, read_judged(patterns, codes));
  std::optional<FixedDisparity> disparity;
  if (reads_moved_pictures) {
    E2LF_ASSIGN_OR_RETURN(disparity, read_disparity(config, device));
  }
  E2LF_ASSIGN_OR_RETURN(auto batches, DepthBatches::create(config, codes, std::move(dataset), device));
  seed_initial_weights(config);
  std::unique_ptr<Task> task;
  if (reads_moved_pictures) {
    task =
        std::make_unique<MovedViewsTask>(config, std::move(batches), std::move(judged), *std::move(disparity), device);
  } else {
    task = std::make_unique<DepthTask>(config, std::move(batches), codes, std::move(judged), device);
  }
  return task;
}

}  // namespace e2lf::learn
