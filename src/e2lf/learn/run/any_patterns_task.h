// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/run/task.h"

/// What the tasks of networks for any patterns share.
namespace e2lf::learn {

/// A set of patterns with which a network is judged, and its name, which is empty for patterns.codes.
struct JudgedSet {
  std::string name;
  capture::Codes codes;
};

/// The events of one scene as a batch, continued by mirror images to a size that networks take.
struct JudgedEvents {
  torch::Tensor events, cycles;  ///< as those of DepthBatch
  SampleConstants constants;
  double events_per_pixel = 0;
};

/// Takes of a map [y, x] of a judged scene what is inside of the scene and of a border of 15 px.
[[nodiscard]] torch::Tensor judged_part(const torch::Tensor& map, const Scene& scene);

/// Checks that the disparity of a scene is known, by which networks of disparity are judged.
[[nodiscard]] Result<void> check_disparity(const Scene& scene);

/// Returns the share of disparities that are wrong, in %, without a border of 15 px.
[[nodiscard]] double wrong_disparities(const torch::Tensor& disparity, const Scene& scene);

/// Returns the weights of a network of disparity that Muon updates. The layers with few outputs are left to Adam.
[[nodiscard]] NamedTensors disparity_weights_of_muon(const NetworkModule& network);

/// Returns the scale of the last of the levels with these widths, of which height and width are multiples.
[[nodiscard]] int64_t scale_of_last_level(const std::vector<size_t>& widths);

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
                                                         const Judgement& judgement) const override;

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

/// Opens the task of a configuration that reads moved pictures. Fails as read_model() does for the network of
/// disparity, and with kInvalidValue if it is not one for any patterns.
[[nodiscard]] Result<std::unique_ptr<Task>> open_moved_pictures_task(const Config& config, DepthBatches batches,
                                                                     std::vector<JudgedSet> judged,
                                                                     torch::Device device);

}  // namespace e2lf::learn
