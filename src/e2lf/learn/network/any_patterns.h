// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/model/composition.h"

/// The training of networks of disparity, and of views on moved pictures, for any patterns, whose weights
/// geometry::for_patterns() makes for those of the events. In training, each sample has its own, so that the maps of
/// the patterns are applied to its inputs instead.
namespace e2lf::learn {

/// What a network is told of the patterns of each sample, with P pictures; see geometry::Aperture.
struct Apertures {
  std::vector<int64_t> transitions;  ///< of the pictures, the same for all samples
  int64_t lit = 0;                   ///< transitions whose transmissions are known: those before the inverses
  torch::Tensor slots, moments;      ///< [batch, 3, P]
  torch::Tensor gains, weights;      ///< [batch, P]
  torch::Tensor constants;           ///< [batch, geometry::kApertureConstants]
  torch::Tensor offsets;             ///< float64 on the CPU, [batch, P, 2]
};

/// Describes the patterns of each sample, of which all have pictures in the same places. Fails as
/// geometry::describe_aperture() does.
[[nodiscard]] Result<Apertures> describe_apertures(const std::vector<capture::Codes>& codes, torch::Device device);

/// The layers of e2lf-depth for one scale and three lit patterns, with widths of the levels from half of the resolution
/// on, and the input for `num_inputs` channels. geometry::for_patterns() adapts them.
[[nodiscard]] model::Network depth_network(const std::vector<size_t>& widths, size_t num_inputs);

/// The same layers for pictures that were moved to geometry::kPlaces. Their result is added to a multiple of the
/// disparity that moved these.
[[nodiscard]] model::Network depth_network_of_moved_pictures(const std::vector<size_t>& widths);

/// Changes weights of depth_network() so that the result of the layers for moved pictures is the mean of its disparity
/// and of that which moved the pictures.
void begin_with_mean_of_disparities(model::Weights& weights);

/// The measurements of a batch as inputs.
struct DepthInputs {
  torch::Tensor groups;        ///< cumulative counts, levels, intensities of the transitions: [batch, 3, N - 1, y, x]
  torch::Tensor conditioning;  ///< the conditioning vectors [batch, capture::conditioning_size(N)]
  torch::Tensor cycles;        ///< their number of cycles, which may differ between pixels: [batch, y, x]
};

/// Forms these inputs of events [batch, N - 1, y, x] that are means over `cycles` [batch, y, x], as the input groups
/// `groups` of a model state: cumulative counts, levels, intensities, and the camera, which is last.
[[nodiscard]] DepthInputs form_depth_inputs(const torch::Tensor& events, const SampleConstants& constants,
                                            const torch::Tensor& cycles, const std::vector<model::InputGroup>& groups);

/// A network of disparity for any patterns.
class AnyPatternsModule {
 public:
  /// Initialises the weights as NetworkModule does.
  AnyPatternsModule(const std::vector<size_t>& widths, torch::Device device);

  /// Returns the disparity of view (4, 4) and the logarithm of its scale, [batch, 2, y, x]. y and x are multiples of
  /// the last level's scale. The other parameters are those of NetworkModule::forward().
  [[nodiscard]] torch::Tensor forward(const DepthInputs& inputs, const Apertures& apertures, torch::ScalarType compute,
                                      const NamedTensors* weights = nullptr, NamedTensors* input_means = nullptr) const;

  [[nodiscard]] const NetworkModule& module() const { return module_; }

  /// Stores weights in a model: those for any patterns as such, and the others by layer.
  static void store(const NamedTensors& weights, model::Model& model);

 private:
  [[nodiscard]] torch::Tensor stem(const DepthInputs& inputs, const Apertures& apertures,
                                   const torch::Tensor& constants, torch::ScalarType compute,
                                   const NamedTensors& weights) const;
  [[nodiscard]] torch::Tensor features(const DepthInputs& inputs, const torch::Tensor& constants,
                                       torch::ScalarType compute, const NamedTensors& weights) const;
  NetworkModule module_;
};

/// Returns the weights of a model for any patterns (Model::any_patterns) by the names of the parameters of
/// AnyPatternsModule.
[[nodiscard]] model::Weights weights_for_any_patterns(const model::Model& model);

/// Returns whether a tensor of weights depends on the patterns.
[[nodiscard]] bool depends_on_patterns(const std::string& name);

/// Returns InputKind::kMoved, [batch, model::kMovedPlanes, y, x], of the pictures behind the patterns of each sample.
/// `disparity` [batch, 2, y, x] is the output of a network of disparity for `inputs`, and `patterns` state how the
/// planes are made of both.
[[nodiscard]] torch::Tensor moved_planes(const DepthInputs& inputs, const torch::Tensor& disparity,
                                         const std::vector<model::MovedInput>& patterns);

}  // namespace e2lf::learn
