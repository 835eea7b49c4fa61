// SPDX-License-Identifier: MIT
#include "e2lf/model/composition.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::model {
namespace {

Error misfit(const std::string& location, const std::string& message) {
  return fail(ErrorCode::kInvalidValue, location, message);
}

/// A matrix [rows, columns] of zeros, whose elements are then set.
struct Matrix {
  Matrix(size_t num_rows, size_t num_columns) : rows(num_rows), columns(num_columns), values(rows * columns) {}
  [[nodiscard]] float& operator()(size_t row, size_t column) { return values[row * columns + column]; }
  size_t rows, columns;
  std::vector<float> values;
};

/// Layers that are appended to a network. They are named, because later ones read them.
class Graph {
 public:
  explicit Graph(WeightedNetwork& to) : network_(&to.network), weights_(&to.weights) {}

  void add(Layer layer) { network_->layers.push_back(std::move(layer)); }

  void concat(const std::string& name, std::vector<std::string> inputs) {
    add({.name = name, .op = Op::kConcat, .inputs = std::move(inputs)});
  }

  /// Adds a convolution with a weight [out, in] for one pixel, or of the mean over `window` x `window` px. An empty
  /// bias is 0.
  Layer& conv(const std::string& name, const std::string& input, const Matrix& weight, std::vector<float> bias = {},
              size_t window = 1) {
    const size_t area = window * window;
    std::vector<float>& values = (*weights_)[name + ".weight"];
    for (const float value : weight.values) values.insert(values.end(), area, value / static_cast<float>(area));
    bias.resize(weight.rows);
    (*weights_)[name + ".bias"] = std::move(bias);
    add({.name = name, .inputs = {input}, .out_channels = weight.rows, .kernel = window});
    return network_->layers.back();
  }

  void relu(const std::string& name, const std::string& input, const Matrix& weight, std::vector<float> bias = {},
            size_t window = 1) {
    conv(name, input, weight, std::move(bias), window).relu = true;
  }

 private:
  Network* network_;
  Weights* weights_;
};

/// Appends a network whose names get a prefix, and which reads `input` instead of the input.
void append(WeightedNetwork part, const std::string& prefix, const std::string& input, WeightedNetwork& to) {
  const auto renamed = [&](const std::string& name) { return name == "input" ? input : prefix + name; };
  for (Layer& layer : part.network.layers) {
    layer.name = prefix + layer.name;
    for (std::string& name : layer.inputs) name = renamed(name);
    if (!layer.residual.empty()) layer.residual = renamed(layer.residual);
    to.network.layers.push_back(std::move(layer));
  }
  for (auto& [name, values] : part.weights) to.weights[prefix + name] = std::move(values);
}

/// Returns the number of the first channel of the camera, or that of all channels if the network is not conditioned.
size_t first_of_camera(const Model& model) {
  size_t first = 0;
  for (const InputGroup& group : model.input) {
    if (group.kind == InputKind::kCamera) break;
    first += num_input_channels(group.kind, model.num_patterns);
  }
  return first;
}

// Two scales.

constexpr const char* kHalf = "half_";

/// Adds the input of the half scale: means over 2x2 pixels, which are as free of noise as those over four cycles.
void add_half_input(const Model& model, WeightedNetwork& to) {
  constexpr size_t kSide = 2, kCycles = 4;
  const size_t channels = model.network.input_channels;
  std::vector<float> weight(channels * channels * kSide * kSide), bias(channels);
  for (size_t c = 0; c < channels; ++c) {
    std::fill_n(weight.begin() + static_cast<ptrdiff_t>((c * channels + c) * kSide * kSide), kSide * kSide, 0.25F);
  }
  const auto camera = std::ranges::find(model.input, InputKind::kCamera, &InputGroup::kind);
  if (camera != model.input.end()) {
    bias[first_of_camera(model) + capture::kCyclesCondition] = camera->scale * capture::cycles_condition(kCycles);
  }
  to.weights["half_input.weight"] = std::move(weight);
  to.weights["half_input.bias"] = std::move(bias);
  to.network.layers.push_back(
      {.name = "half_input", .inputs = {"input"}, .out_channels = channels, .kernel = kSide, .stride = kSide});
}

/// Adds the mean of the disparity and of the logarithm of its scale, which the full scale gives for the four pixels
/// behind a pixel of the half scale.
void add_mean(WeightedNetwork& to, const std::string& full, const std::string& half, float share) {
  constexpr size_t kPixels = 4;
  Graph graph(to);
  graph.concat("both_scales", {full, half});
  Matrix weight(kDepthOutputs * kPixels, kDepthOutputs * kPixels + kDepthOutputs);
  std::vector<float> bias(weight.rows);
  for (size_t row = 0; row < weight.rows; ++row) {
    const bool is_disparity = row < kPixels;
    weight(row, row) = share;
    weight(row, weight.rows + (is_disparity ? 0 : 1)) = (1 - share) * (is_disparity ? 2.0F : 1.0F);
    if (!is_disparity) bias[row] = (1 - share) * std::numbers::ln2_v<float>;
  }
  graph.conv("mean", "both_scales", weight, std::move(bias));
}

// The guide.

constexpr const char* kGuide = "guide_";
constexpr size_t kPlanes = 24;
constexpr double kNearest = -3.45, kPlaneStep = 0.3;  ///< disparities of the planes, near to far, px per view step
constexpr size_t kWindow = 9;                         ///< of the local mean of the picture and of its detail, px
/// Logit of the opacity, per plane in front of the surface. The plane before it covers the share that its distance
/// leaves.
constexpr float kSteepness = 5.0F;
constexpr float kLargestLogit = 6.0F;
constexpr float kMuted = 0.5F;  ///< by how much a difference moves towards zero where the surface has no say

/// Returns the positions of views along an axis, from `centre`.
std::vector<double> viewpoints(size_t views, double centre) {
  std::vector<double> result;
  for (size_t view = 0; view < views; ++view) result.push_back(static_cast<double>(view) - centre);
  return result;
}

double middle_of(size_t views) {
  return 0.5 * static_cast<double>(views - 1);
}

/// Returns the weight of the central picture, the mean of the one, two or four views in the middle.
Matrix central_picture(size_t views_y, size_t views_x) {
  Matrix weight(1, views_y * views_x);
  const size_t top = (views_y - 1) / 2, bottom = views_y / 2, left = (views_x - 1) / 2, right = views_x / 2;
  const auto count = static_cast<float>((bottom - top + 1) * (right - left + 1));
  for (size_t y = top; y <= bottom; ++y) {
    for (size_t x = left; x <= right; ++x) weight(0, y * views_x + x) = 1 / count;
  }
  return weight;
}

/// Adds `muted`, which is 0 where the picture has weak detail, and kMuted where it has at least twice as much.
void add_muting(Graph& graph, float weak_texture) {
  const float slope = kMuted / weak_texture;
  Matrix one(1, 1), difference(2, 2), detail(1, 2), minus(1, 1);
  one(0, 0) = 1;
  difference(0, 0) = difference(1, 1) = 1;
  difference(0, 1) = difference(1, 0) = -1;
  detail(0, 0) = detail(0, 1) = -slope;
  minus(0, 0) = -1;
  graph.conv("local_mean", "picture", one, {}, kWindow);
  graph.concat("picture_and_mean", {"picture", "local_mean"});
  graph.relu("picture_detail", "picture_and_mean", difference);
  graph.relu("unmuted", "picture_detail", detail, {2 * kMuted}, kWindow);
  graph.relu("muted", "unmuted", minus, {kMuted});
}

/// Adds `surface`, the views of the picture, whose viewpoints are given, on a surface at the disparity of a layer.
/// Planes behind the surface are opaque, too, and not seen.
void add_surface(Graph& graph, const std::string& disparity, std::vector<double> rows, std::vector<double> columns) {
  std::vector<double> planes;
  for (size_t plane = 0; plane < kPlanes; ++plane) {
    planes.push_back(std::round(100 * (kNearest + kPlaneStep * static_cast<double>(plane))) / 100);
  }
  const double per_px = kSteepness / kPlaneStep;
  Matrix below(kPlanes, kDepthOutputs), opacities(kPlanes, kPlanes), layers(2 * kPlanes, kPlanes + 1);
  std::vector<float> of_below(kPlanes), of_layers(2 * kPlanes);
  for (size_t plane = 0; plane < kPlanes; ++plane) {
    below(plane, 0) = static_cast<float>(per_px);
    of_below[plane] = static_cast<float>(double{kLargestLogit - kSteepness / 2} - per_px * planes[plane]);
    opacities(plane, plane) = -1;
    layers(plane, plane) = layers(kPlanes + plane, kPlanes) = 1;
    of_layers[plane] = -kLargestLogit;
  }
  graph.relu("below", disparity, below, std::move(of_below));
  graph.relu("opacities", "below", opacities, std::vector<float>(kPlanes, 2 * kLargestLogit));
  graph.concat("opacities_and_picture", {"opacities", "picture"});
  graph.conv("surface_layers", "opacities_and_picture", layers, std::move(of_layers));
  graph.add({.name = "surface",
             .op = "render-layers",
             .inputs = {"surface_layers"},
             .attributes = {{"disparities", planes}, {"rows", std::move(rows)}, {"columns", std::move(columns)}}});
}

/// Adds the result: views that become those of the surface where nothing is muted.
void add_guided(Graph& graph, const std::string& views, size_t number) {
  graph.concat("views_and_surface", {views, "surface", "muted"});
  Matrix differences(2 * number, 2 * number + 1), guided(number, 2 * number);
  for (size_t view = 0; view < number; ++view) {
    differences(view, view) = differences(number + view, number + view) = -1;
    differences(view, number + view) = differences(number + view, view) = 1;
    differences(view, 2 * number) = differences(number + view, 2 * number) = -1;
    guided(view, view) = 1;
    guided(view, number + view) = -1;
  }
  graph.relu("differences", "views_and_surface", differences);
  graph.conv("guided", "differences", guided).residual = views;
}

/// Adds views that follow the disparity where the picture has weak texture.
void add_following(Graph& graph, const std::string& of_views, const std::string& of_disparity, const Model& views,
                   const Guide& guide) {
  graph.conv("picture", of_views, central_picture(views.views_y, views.views_x));
  add_muting(graph, guide.weak_texture);
  add_surface(graph, of_disparity, viewpoints(views.views_y, middle_of(views.views_y)),
              viewpoints(views.views_x, middle_of(views.views_x)));
  add_guided(graph, of_views, views.views_y * views.views_x);
}

/// Builds the paper's sensor into the weights of a network that is conditioned on the camera. Its layers then need the
/// other inputs and a channel of ones.
Result<void> build_in_paper(Model& disparity) {
  const size_t first = first_of_camera(disparity);
  if (disparity.input.back().kind != InputKind::kCamera) {
    return misfit(disparity.name, "the camera is not the last of its inputs; make it the last");
  }
  std::vector<float> conditioning =
      capture::conditioning_vector(capture::SensorProfile(), disparity.num_patterns, /*cycles=*/1);
  for (float& value : conditioning) value *= disparity.input.back().scale;
  auto built = with_constant_inputs(disparity.network, disparity.weights, first, conditioning);
  if (!built) return misfit(disparity.name, "other layers than convolutions read the camera; use another network");
  disparity.network = std::move(built->network);
  disparity.weights = std::move(built->weights);
  disparity.input.pop_back();
  return {};
}

/// Adds the inputs and a channel of ones, and returns its name. The network makes the ones itself, so that zeros beside
/// the image stay zeros.
std::string add_known(size_t inputs, WeightedNetwork& to) {
  const std::string one = cat(kGuide, "one"), known = cat(kGuide, "known");
  Graph graph(to);
  graph.conv(one, "input", Matrix(1, inputs), {1});
  graph.concat(known, {"input", one});
  return known;
}

/// Returns the inputs of two networks in the order of their kinds.
std::vector<InputGroup> inputs_of_both(const Model& a, const Model& b) {
  std::vector<InputGroup> both = a.input;
  for (const InputGroup& group : b.input) {
    if (std::ranges::find(both, group) == both.end()) both.push_back(group);
  }
  std::ranges::stable_sort(both, {}, &InputGroup::kind);
  return both;
}

/// Gives a network the inputs among `all` that it does not use.
Result<void> add_unused_inputs(const std::vector<InputGroup>& all, Model& model) {
  size_t place = 0, channel = 0;
  for (const InputGroup& group : all) {
    const size_t count = num_input_channels(group.kind, model.num_patterns);
    if (place < model.input.size() && model.input[place] == group) {
      ++place;
    } else {
      auto with_more = with_unused_inputs(model.network, model.weights, channel, count);
      if (!with_more) return misfit(model.name, "other layers than convolutions read the input; use another network");
      model.network = std::move(with_more->network);
      model.weights = std::move(with_more->weights);
    }
    channel += count;
  }
  const bool has_one_scale = std::ranges::adjacent_find(all, {}, &InputGroup::kind) == all.end();
  if (place == model.input.size() && has_one_scale) {
    model.input = all;
    return {};
  }
  return misfit(model.name,
                "its inputs have another order or scale than those of the other network; use networks with the same");
}

Result<void> check_limit(const Model& views, const Guide& guide) {
  if (guide.weak_texture > 0.0F && guide.weak_texture <= 1.0F) return {};
  return misfit(views.name,
                cat("the limit of weak texture is ", guide.weak_texture, "; use more than 0, and at most 1"));
}

Result<void> check_that_both_fit(const Model& views, const Model& disparity) {
  if (is_depth_network(views)) return misfit(views.name, "it gives disparities; name a network of views");
  if (!is_depth_network(disparity)) return misfit(disparity.name, "it gives views; name a network of disparity");
  if (views.codes == disparity.codes && views.num_patterns == disparity.num_patterns) return {};
  return misfit(disparity.name,
                cat("it was trained for other patterns than ", views.name, "; use networks for the same patterns"));
}

// Moved pictures.

constexpr const char* kOfMoved = "views_";
constexpr double kFarthestRead = 3.6;  ///< px per view step: as far as pictures are moved

Matrix matrix_of(const LinearStep& step) {
  Matrix matrix(step.bias.size(), step.weight.size() / step.bias.size());
  matrix.values = step.weight;
  return matrix;
}

Layer warp(std::string name, std::vector<std::string> inputs, std::vector<double> offsets) {
  return {.name = std::move(name),
          .op = "warp",
          .inputs = std::move(inputs),
          .attributes = {{"offsets", std::move(offsets)}, {"disparities", {-kFarthestRead, kFarthestRead}}}};
}

/// Returns the choice of as many views of `views` as `fewer` has, with the same reference view.
Matrix views_around_reference(const Model& views, const Model& fewer) {
  const size_t top = views.views_y / 2 - fewer.views_y / 2, left = views.views_x / 2 - fewer.views_x / 2;
  Matrix chosen(fewer.views_y * fewer.views_x, views.views_y * views.views_x);
  for (size_t view = 0; view < chosen.rows; ++view) {
    const size_t row = top + view / fewer.views_x, column = left + view % fewer.views_x;
    chosen(view, row * views.views_x + column) = 1;
  }
  return chosen;
}

/// Adds `planes`, InputKind::kMoved of pictures that are moved by a disparity.
void add_moved_planes(const MovedInput& input, const std::string& disparity, WeightedNetwork& to) {
  Graph graph(to);
  Matrix chosen(input.moved.size(), to.network.input_channels);
  for (size_t c = 0; c < chosen.rows; ++c) chosen(c, input.moved[c]) = 1;
  graph.conv("coded_pictures", "input", chosen);
  std::vector<std::string> known = {"input"};
  for (size_t place = 0; place < input.num_places(); ++place) {
    for (Layer& layer : moves_to_place(input, place, "coded_pictures", disparity)) graph.add(std::move(layer));
    known.push_back(to.network.layers.back().name);
  }
  known.push_back(disparity);
  graph.concat("known", known);
  std::string last = "known";
  for (const LinearStep& step : input.rectified) {
    const std::string number = std::to_string(known.size());
    graph.relu("rectified" + number, last, matrix_of(step), step.bias);
    known.push_back("rectified" + number);
    graph.concat("known" + number, {last, known.back()});
    last = "known" + number;
  }
  graph.conv("planes", last, matrix_of(input.planes), input.planes.bias);
}

/// Adds the result of a network of views for moved pictures: as many views as the patterns of `disparity` have cells,
/// which follow it unless no texture is weak.
Result<void> add_own_views(std::string of_views, const std::string& of_disparity, const Model& disparity,
                           const Guide& guide, Model& views, WeightedNetwork& to) {
  const bool follow = guide.weak_texture != 0.0F;
  if (follow) E2LF_RETURN_IF_ERROR(check_limit(views, guide));
  Graph graph(to);
  if (disparity.views_y != views.views_y || disparity.views_x != views.views_x) {
    graph.conv("own_views", of_views, views_around_reference(views, disparity));
    of_views = "own_views";
    views.views_y = disparity.views_y;
    views.views_x = disparity.views_x;
  }
  if (follow) add_following(graph, of_views, of_disparity, views, guide);
  return {};
}

}  // namespace

Result<Model> at_two_scales(Model network, float share) {
  if (!(share >= 0.0F && share <= 1.0F)) {
    return misfit(network.name, cat("the share of the full scale is ", share, "; use 0 to 1"));
  }
  const Layer last = network.network.layers.back();
  if (!is_depth_network(network) || last.op != Op::kPixelShuffle || last.stride != 2) {
    return misfit(network.name,
                  "only a network of disparity whose last layer is a pixel shuffle by 2 works at two scales; state no "
                  "share of the full scale");
  }
  WeightedNetwork both{network.network, network.weights};
  both.network.layers.pop_back();
  add_half_input(network, both);
  append({std::move(network.network), std::move(network.weights)}, kHalf, "half_input", both);
  add_mean(both, last.inputs.front(), kHalf + last.name, share);
  both.network.layers.push_back(last);
  both.network.layers.back().inputs = {"mean"};
  network.network = std::move(both.network);
  network.weights = std::move(both.weights);
  return network;
}

Result<Model> guided(Model views, Model disparity, const Guide& guide) {
  E2LF_RETURN_IF_ERROR(check_that_both_fit(views, disparity));
  E2LF_RETURN_IF_ERROR(check_limit(views, guide));
  WeightedNetwork both;
  const bool has_known_camera = is_conditioned_on_camera(disparity) && !is_conditioned_on_camera(views);
  if (has_known_camera) E2LF_RETURN_IF_ERROR(build_in_paper(disparity));
  const std::vector<InputGroup> inputs = inputs_of_both(views, disparity);
  for (Model* part : {&views, &disparity}) E2LF_RETURN_IF_ERROR(add_unused_inputs(inputs, *part));
  both.network.input_channels = views.network.input_channels;
  const std::string input = has_known_camera ? add_known(both.network.input_channels, both) : "input";
  const std::string of_views = views.network.layers.back().name;
  const std::string of_disparity = kGuide + disparity.network.layers.back().name;
  append({std::move(disparity.network), std::move(disparity.weights)}, kGuide, input, both);
  append({std::move(views.network), std::move(views.weights)}, "", "input", both);
  Graph graph(both);
  add_following(graph, of_views, of_disparity, views, guide);
  views.network = std::move(both.network);
  views.weights = std::move(both.weights);
  views.precision_loss = {};
  views.provenance["guided_by"] = disparity.name;
  return views;
}

std::vector<Layer> moves_to_place(const MovedInput& input, size_t place, const std::string& pictures,
                                  const std::string& disparity) {
  constexpr size_t kIterations = 2;
  const double row = input.places[2 * place], column = input.places[2 * place + 1];
  std::vector<Layer> layers;
  std::string there = disparity;
  for (size_t i = 0; i < kIterations; ++i) {
    layers.push_back(warp(cat("place", place, "_disparity", i), {disparity, there}, {-row, -column}));
    there = layers.back().name;
  }
  std::vector<double> offsets;
  for (size_t p = 0; p < input.pictures.size(); p += 2) {
    offsets.insert(offsets.end(), {input.pictures[p] - row, input.pictures[p + 1] - column});
  }
  layers.push_back(warp(cat("place", place), {pictures, there}, std::move(offsets)));
  return layers;
}

Result<Model> on_moved_pictures(Model network, Model disparity, const MovedInput& input, const Guide& guide) {
  if (!is_depth_network(disparity)) return misfit(disparity.name, "it gives views; name a network of disparity");
  if (!reads_moved_pictures(network)) return misfit(network.name, "it reads events; name a network of moved pictures");
  WeightedNetwork both;
  const std::string of_disparity = kGuide + disparity.network.layers.back().name;
  both.network.input_channels = disparity.network.input_channels;
  append({std::move(disparity.network), std::move(disparity.weights)}, kGuide, "input", both);
  add_moved_planes(input, of_disparity, both);
  const bool gives_views = !is_depth_network(network);
  const std::string last = kOfMoved + network.network.layers.back().name;
  append({std::move(network.network), std::move(network.weights)}, kOfMoved, "planes", both);
  if (gives_views) E2LF_RETURN_IF_ERROR(add_own_views(last, of_disparity, disparity, guide, network, both));
  network.views_y = disparity.views_y;
  network.views_x = disparity.views_x;
  network.input = disparity.input;
  network.num_patterns = disparity.num_patterns;
  network.codes = disparity.codes;
  network.black_first = disparity.black_first;
  network.network = std::move(both.network);
  network.weights = std::move(both.weights);
  network.provenance["disparity_of"] = disparity.name;
  return network;
}

}  // namespace e2lf::model
