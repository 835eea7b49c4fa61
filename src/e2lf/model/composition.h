// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/model/model.h"

/// Networks that are composed of others when a model file is opened, so that no file holds copies of weights.
namespace e2lf::model {

/// How the views of one network follow the disparity of another where the picture has no more than weak texture, as
/// model files state it under `composed_of`. There, the parallax of a network of views collapses towards zero.
struct Guide {
  /// Names of the two model files, without extension. A file without `views` holds a network that reads
  /// InputKind::kMoved.
  std::string views = {}, disparity = {};
  /// Where the mean absolute detail of the central picture is below this share of white, the views become those of
  /// this picture on a surface at the disparity. Where it is above twice as much, they are not changed. Views of moved
  /// pictures do not follow the disparity if it is 0.
  float weak_texture = 0.01F;
  std::optional<float> share_of_full_scale = {};  ///< of the disparity; empty = that which its own file states
};

/// Returns a network of disparity that works at two scales: its disparities are `share` times those of `network` plus
/// (1 - share) times those for the means of the events over 2x2 pixels, which have half of the noise and of the
/// disparity. Fails with kInvalidValue unless share is in [0, 1] and the network ends in a pixel shuffle by 2.
[[nodiscard]] Result<Model> at_two_scales(Model network, float share);

/// Composes a network of views that follows a network of disparity for the same patterns. If only the network of
/// disparity is conditioned on the camera, the paper's sensor is built into its weights. The result has the name and
/// the properties of `views`, except for precision_loss, and the inputs of both in the order of InputKind, in which
/// each network must have its own. Fails with kInvalidValue if the two do not fit together.
[[nodiscard]] Result<Model> guided(Model views, Model disparity, const Guide& guide);

/// Linear combinations of channels: weights [bias.size(), channels], row-major.
struct LinearStep {
  std::vector<float> weight, bias;
};

/// How a network that reads InputKind::kMoved reads the events behind certain patterns. All weights belong to the
/// inputs of the network of disparity, in their order.
struct MovedInput {
  std::vector<double> pictures;  ///< offsets of P pictures from the reference view, (row, column), view steps
  std::vector<double> places;    ///< offsets of K viewpoints to which each picture is moved by the disparity
  std::vector<size_t> moved;     ///< the input channels that are moved, feature g of picture p at g P + p
  /// What is made of the channels that are known: those of the input, what was moved to each place, and disparity and
  /// logarithm of its scale. Each step adds its results to them; the last one, which is not rectified, gives
  /// InputKind::kMoved.
  std::vector<LinearStep> rectified = {};
  LinearStep planes = {};

  [[nodiscard]] size_t num_places() const { return places.size() / 2; }
};

/// Composes a network that reads InputKind::kMoved with one of disparity, which moves the pictures behind the patterns.
/// The result has the name and the properties of `network`, and the inputs of `disparity`. Views follow the disparity
/// as those of guided() do, and are as many around the reference view as the patterns of `disparity` have cells; a
/// network of disparity gives that of these pictures. Fails with kInvalidValue unless reads_moved_pictures(network) and
/// `disparity` gives disparities.
[[nodiscard]] Result<Model> on_moved_pictures(Model network, Model disparity, const MovedInput& input,
                                              const Guide& guide);

/// Returns the layers of on_moved_pictures() that move the layer `pictures` to a place: the disparity is moved there
/// first, by a fixed-point iteration, and the pictures by the result, which are the last layer.
[[nodiscard]] std::vector<Layer> moves_to_place(const MovedInput& input, size_t place, const std::string& pictures,
                                                const std::string& disparity);

/// A guide by a network for any patterns, or by one for patterns similar to those of views whose file states none,
/// which waits for the patterns of the events. Model::open_guide refers to it in models whose other members are those
/// of the network of views.
struct OpenGuide {
  Guide guide;
  Model disparity;
};

/// What a model file states, without its weights; of a composed model, what its views state, and the guide.
struct StatedModel {
  Model model;
  std::optional<Guide> guide = {};
  bool is_for_any_patterns = false;
};

/// Reads the header of a model file and its patterns. Fails as read_model() does, but does not check the weights.
[[nodiscard]] Result<StatedModel> read_stated_model(const std::filesystem::path& path);

}  // namespace e2lf::model
