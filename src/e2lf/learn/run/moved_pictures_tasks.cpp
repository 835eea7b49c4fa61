// SPDX-License-Identifier: MIT
// The tasks of networks that read moved pictures, of views and of disparity.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/any_patterns_task.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

/// A network of disparity for any patterns that stays as it is, with the input groups and the number of levels that its
/// file states.
struct FixedDisparity {
  std::string name;
  std::vector<model::InputGroup> input;
  AnyPatternsModule network;
  int64_t multiple = 1;  ///< of the height and width
};

/// A task whose network reads pictures that a network of disparity has moved.
class MovedPicturesTask : public AnyPatternsTask {
 public:
  MovedPicturesTask(const Config& config, DepthBatches batches, std::vector<JudgedSet> judged, FixedDisparity disparity,
                    torch::Device device)
      : AnyPatternsTask(config, std::move(batches), std::move(judged), device),
        disparity_(std::move(disparity)),
        network_(make_network(config), device) {}

  [[nodiscard]] const NetworkModule& network() const override { return network_; }

  /// The first planes are the inputs of networks for the patterns of e2lf-n4 that are conditioned on the sensor, so
  /// that these can be the start, too.
  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    if (model::is_depth_network(model) != config_.network.gives_disparity()) {
      return fail(ErrorCode::kInvalidValue, "",
                  config_.network.gives_disparity() ? "this network gives views; start from one of disparity"
                                                    : "this network gives disparities; start from one of views");
    }
    if (model::reads_moved_pictures(model)) return model.weights;
    auto weights = weights_on_events(model);
    if (weights && config_.network.gives_disparity()) begin_with_mean_of_disparities(*weights);
    if (weights) return *std::move(weights);
    return fail(ErrorCode::kInvalidValue, "",
                "this network reads neither moved pictures nor the events and the sensor of four patterns; start from "
                "e2lf-n4-camera for views, or from e2lf-n4-depth for disparities");
  }

  /// The model names its network of disparity, and has no patterns of its own.
  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const override {
    model.codes.reset();
    model.network = network_.network();
    model.weights = to_weights(weights);
    model::OpenGuide guide;
    guide.guide.disparity = disparity_.name;
    guide.guide.weak_texture = static_cast<float>(config_.network.weak_texture);
    model.open_guide = std::make_shared<const model::OpenGuide>(std::move(guide));
    return model;
  }

 protected:
  [[nodiscard]] int64_t multiple() const override {
    return std::max(disparity_.multiple, scale_of_last_level(config_.network.widths));
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

 private:
  /// Returns the weights of a network for four patterns with zeros for the planes that it does not read; nothing if it
  /// reads others.
  static std::optional<model::Weights> weights_on_events(const model::Model& model) {
    if (model.num_patterns != 4) return {};
    model::WeightedNetwork result{model.network, model.weights};
    const auto insert = [&](size_t first, size_t count) {
      auto with_more = with_unused_inputs(result.network, result.weights, first, count);
      if (!with_more) return false;
      result = *std::move(with_more);
      return true;
    };
    size_t known = 0;
    auto group = model.input.begin();
    for (const model::InputKind kind : model::kInputsOfMoved) {
      const size_t channels = model::num_input_channels(kind, model.num_patterns);
      if (group != model.input.end() && group->kind == kind) {
        ++group;
      } else if (kind == model::InputKind::kCamera || !insert(known, channels)) {
        return {};
      }
      known += channels;
    }
    if (group != model.input.end() || !insert(known, model::kMovedPlanes - known)) return {};
    return std::move(result.weights);
  }
};

/// Scores are the PSNR of all views without a border of 15 px.
class MovedViewsTask : public MovedPicturesTask {
 public:
  using MovedPicturesTask::MovedPicturesTask;

  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_views(); }
  [[nodiscard]] NamedTensors weights_of_muon() const override { return muon_weights(network_); }

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

 private:
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
};

/// Corrects the disparities that moved the pictures. Scores are wrong_disparities().
class MovedDepthTask : public MovedPicturesTask {
 public:
  using MovedPicturesTask::MovedPicturesTask;

  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_disparity(); }
  [[nodiscard]] NamedTensors weights_of_muon() const override { return disparity_weights_of_muon(network_); }

  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& /*codes*/,
                                      NamedTensors* input_means) override {
    const DepthBatch batch = batches_.at(step, share);
    E2LF_ASSIGN_OR_RETURN(const auto planes,
                          planes_of(batch.events, batch.constants, batch.cycles, batch.codes, compute_));
    return depth_loss(network_.forward(planes, compute_, nullptr, input_means), batch.disparity);
  }

 private:
  [[nodiscard]] Result<void> check_scene(const Scene& scene) const override { return check_disparity(scene); }

  [[nodiscard]] Result<double> judge(const NamedTensors& weights, const capture::Codes& codes, const Scene& scene,
                                     const JudgedEvents& judged) const override {
    E2LF_ASSIGN_OR_RETURN(const auto planes,
                          planes_of(judged.events, judged.constants, judged.cycles, {codes}, torch::kFloat));
    return wrong_disparities(network_.forward(planes, torch::kFloat, &weights)[0][0], scene);
  }
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
                " is no network of disparity for any patterns; name one that reads events, such as e2lf-depth-first");
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

Result<std::unique_ptr<Task>> open_moved_pictures_task(const Config& config, DepthBatches batches,
                                                       std::vector<JudgedSet> judged, torch::Device device) {
  E2LF_ASSIGN_OR_RETURN(FixedDisparity disparity, read_disparity(config, device));
  if (config.network.gives_disparity()) {
    return std::unique_ptr<Task>(
        std::make_unique<MovedDepthTask>(config, std::move(batches), std::move(judged), std::move(disparity), device));
  }
  return std::unique_ptr<Task>(
      std::make_unique<MovedViewsTask>(config, std::move(batches), std::move(judged), std::move(disparity), device));
}

}  // namespace e2lf::learn
