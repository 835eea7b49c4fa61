// SPDX-License-Identifier: MIT
// The task of networks of the central picture for any patterns.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/geometry/central_picture.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/network/central_pictures.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/judged_scenes.h"
#include "e2lf/learn/run/task.h"
#include "e2lf/model/composition.h"

namespace e2lf::learn {
namespace {

constexpr size_t kCentre = 36;  // view (4, 4)

/// A network of disparity for any patterns that stays as it is, with the input groups and the number of levels that its
/// file states.
struct FixedDisparity {
  std::string name;
  std::vector<model::InputGroup> input;
  AnyPatternsModule network;
  int64_t multiple = 1;  ///< of the height and width
};

class PictureTask : public Task {
 public:
  PictureTask(const Config& config, DepthBatches batches, std::vector<JudgedSet> judged, FixedDisparity disparity,
              torch::Device device)
      : config_(config),
        batches_(std::move(batches)),
        judged_(std::move(judged)),
        disparity_(std::move(disparity)),
        network_(picture_network(config.network.widths), device),
        compute_(config.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat),
        device_(device) {
    // Training starts at the mean of the moved pictures.
    constexpr double kInitialDetail = 0.02;
    torch::NoGradGuard no_grad;
    auto head = network_.parameters().at("head.weight");
    head.mul_(kInitialDetail);
  }

  [[nodiscard]] const NetworkModule& network() const override { return network_; }
  [[nodiscard]] LogFigures figures() const override { return LogFigures::of_views(); }
  [[nodiscard]] const std::vector<std::string>& validation() const override { return batches_.validation(); }
  [[nodiscard]] const std::optional<capture::SensorProfile>& camera() const override { return batches_.camera(); }

  [[nodiscard]] NamedTensors weights_of_muon() const override {
    NamedTensors weights = muon_weights(network_);
    weights.erase("head.weight");
    return weights;
  }

  [[nodiscard]] Result<model::Weights> starting_weights(const model::Model& model) const override {
    if (model::is_picture_network(model)) return model.weights;
    return fail(ErrorCode::kInvalidValue, "",
                "this is no network of the central picture; start from one, such as e2lf-any");
  }

  /// The loss is the mean logarithm of the squared errors of the samples, so that each counts by its decibels.
  [[nodiscard]] Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& /*codes*/,
                                      NamedTensors* input_means) override {
    constexpr double kFloor = 1e-5;  // 50 dB
    constexpr int64_t kBorder = 8;   // px
    const DepthBatch batch = batches_.at(step, share);
    E2LF_ASSIGN_OR_RETURN(const CentralPictures moved,
                          centred(batch.events, batch.constants, batch.cycles, batch.codes, compute_));
    const auto picture = moved.base + network_.forward(moved.planes, compute_, nullptr, input_means).squeeze(1);
    const auto inside = torch::indexing::Slice(kBorder, -kBorder);
    const auto errors = (picture / batch.gain.reshape({-1, 1, 1}) - batch.central)
                            .index({torch::indexing::Slice(), inside, inside})
                            .square()
                            .mean({1, 2});
    return StepLoss{torch::log(errors + kFloor).mean(), errors.detach().mean()};
  }

  /// Scores are the PSNR of the central view without a border of 15 px.
  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const NamedTensors& weights, const torch::Tensor& /*codes*/,
                                                         const std::string& scene,
                                                         const Judgement& judgement) const override {
    E2LF_ASSIGN_OR_RETURN(const Scene* found, batches_.dataset().find(scene));
    return judge_sets(judged_, [&](const auto& codes) { return evaluate_set(weights, codes, *found, judgement); });
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
  /// Moves the pictures of a batch to the central view by the fixed network.
  [[nodiscard]] Result<CentralPictures> centred(const torch::Tensor& events, const SampleConstants& constants,
                                                const torch::Tensor& cycles, const std::vector<capture::Codes>& codes,
                                                torch::ScalarType compute) const {
    torch::NoGradGuard no_grad;
    std::vector<model::CentralInput> central;
    for (const capture::Codes& each : codes) {
      E2LF_ASSIGN_OR_RETURN(central.emplace_back(), geometry::central_input(each, disparity_.input));
    }
    E2LF_ASSIGN_OR_RETURN(const Apertures apertures, describe_apertures(codes, device_));
    const DepthInputs inputs = form_depth_inputs(events, constants, cycles, disparity_.input);
    return move_to_centre(inputs, disparity_.network.forward(inputs, apertures, compute), central);
  }

  [[nodiscard]] Result<SceneScore> evaluate_set(const NamedTensors& weights, const capture::Codes& codes,
                                                const Scene& scene, const Judgement& judgement) const {
    torch::NoGradGuard no_grad;
    E2LF_ASSIGN_OR_RETURN(const JudgedEvents judged,
                          simulate_judged(scene, codes, judgement, disparity_.multiple, device_));
    E2LF_ASSIGN_OR_RETURN(const CentralPictures moved,
                          centred(judged.events, judged.constants, judged.cycles, {codes}, torch::kFloat));
    const auto picture = (moved.base + network_.forward(moved.planes, torch::kFloat, &weights).squeeze(1))[0];
    const auto view = scene.views[kCentre].to(torch::kFloat) / 255.0;
    const auto error = judged_part(picture.clamp(0.0, 1.0), scene) - judged_part(view, scene);
    return SceneScore{scene.name, -10 * std::log10(error.square().mean().item<double>() + 1e-12),
                      judged.events_per_pixel};
  }

  Config config_;
  DepthBatches batches_;
  std::vector<JudgedSet> judged_;
  FixedDisparity disparity_;
  NetworkModule network_;
  torch::ScalarType compute_;
  torch::Device device_;
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
                        int64_t{2} << (widths.size() - 1)};
  if (static_cast<int64_t>(config.train.patch) % result.multiple != 0) {
    return fail(ErrorCode::kInvalidValue, "train.patch", name, " takes multiples of ", result.multiple,
                " px; set train.patch and data.synthesiser.size to one");
  }
  E2LF_RETURN_IF_ERROR(load_weights(result.network.module().parameters(), weights_for_any_patterns(model), name));
  return result;
}

}  // namespace

Result<std::unique_ptr<Task>> open_picture_task(Config& config, Dataset dataset, torch::Device device) {
  PatternConfig& patterns = config.patterns;
  E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_shown(patterns.codes, patterns));
  E2LF_RETURN_IF_ERROR(geometry::central_input(codes, {}));
  patterns.num_patterns = codes.num_patterns;
  E2LF_ASSIGN_OR_RETURN(auto judged, read_judged(patterns, codes));
  E2LF_ASSIGN_OR_RETURN(auto disparity, read_disparity(config, device));
  E2LF_ASSIGN_OR_RETURN(auto batches, DepthBatches::create(config, std::move(codes), std::move(dataset), device));
  seed_initial_weights(config);
  return std::unique_ptr<Task>(
      std::make_unique<PictureTask>(config, std::move(batches), std::move(judged), std::move(disparity), device));
}

}  // namespace e2lf::learn
