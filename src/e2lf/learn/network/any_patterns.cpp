// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/any_patterns.h"

#include <algorithm>
#include <torch/torch.h>

#include "e2lf/base/text.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/aperture.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/model/layer_list.h"

namespace e2lf::learn {
namespace {

using model::LayerList, model::Network;

constexpr int64_t kGroups = 3;       // of inputs: cumulative counts, levels, intensities
constexpr int64_t kIntensities = 2;  // the last group
constexpr int64_t kMoments = 3;      // the central picture and its derivatives
constexpr int64_t kParts = 3;        // of what a picture is compared with: itself, its neighbour, the mean of all
constexpr int64_t kSlots = geometry::kSlots, kKinds = kSlots;  // kinds of pictures that have weights of their own
constexpr int64_t kFeatures = 4;                               // of each picture
constexpr int64_t kSweepScale = 4, kWindow = 7;                // px
constexpr int kMostDisparity = 17;                             // in fifths of a px per view step
/// What is the same at all pixels of the first layers but the number of cycles, which comes last.
constexpr int64_t kConstants = geometry::kApertureConstants + kSlots + capture::kNumFixedConditions - 1;

constexpr size_t kHeadScale = 2;       ///< of the last convolution, px
constexpr const char* kKept = "kept";  ///< what remains of the disparity by which pictures were moved

std::vector<double> compared_disparities() {
  std::vector<double> disparities;
  for (int i = -kMostDisparity; i <= kMostDisparity; ++i) disparities.push_back(i / 5.0);
  return disparities;
}

/// Adds the comparison of the pictures, and how the layers weigh it: returns the name of the last layer.
std::string add_evidence(LayerList& layers, const std::string& half, size_t channels) {
  layers.add({.name = "evidence", .op = model::Op::kConcat, .inputs = {half, "sweep", "features"}});
  const std::string name = layers.conv("weigh", "evidence", channels, 3);
  layers.network.layers.back().residual = half;
  return name;
}

/// The shapes of weights that depend on the patterns.
NetworkModule::Shapes shapes_for_any_patterns(const std::vector<size_t>& widths) {
  const auto size = [](int64_t value) { return static_cast<size_t>(value); };
  const size_t planes = compared_disparities().size();
  return {{"stem.weight", {widths[0], size(kGroups * kSlots + kMoments + kConstants + 1), 2, 2}},
          {"stem.bias", {widths[0]}},
          {"pictures.weight", {size(kKinds), size(kGroups * kParts + kConstants + 1), 4, 4}},
          {"pictures.bias", {size(kKinds)}},
          {"features.weight", {size(kKinds * kFeatures), size(kParts), 5, 5}},
          {"features.bias", {size(kKinds * kFeatures)}},
          {"weigh.weight", {widths[1], widths[1] + planes + size((kSlots + kMoments) * kFeatures), 3, 3}}};
}

/// Returns for each of P pictures [batch, P, ...] the one before it; the one after it for the first.
torch::Tensor neighbours(const torch::Tensor& pictures) {
  return torch::cat({pictures.narrow(1, 1, 1), pictures.narrow(1, 0, pictures.size(1) - 1)}, 1);
}

/// Takes of [batch, P, kind, ...] what was made with the weights of the kind of each picture: the first one follows the
/// black pattern, the second one has another picture before it.
torch::Tensor of_its_kind(const torch::Tensor& x) {
  std::vector<torch::Tensor> chosen;
  for (int64_t p = 0; p < x.size(1); ++p) chosen.push_back(x.select(1, p).select(1, std::min(p, kKinds - 1)));
  return torch::stack(chosen, 1);
}

/// All channels of the input of a network of disparity [batch, channel, y, x].
torch::Tensor all_channels(const DepthInputs& inputs) {
  const int64_t height = inputs.cycles.size(1), width = inputs.cycles.size(2);
  const auto camera = inputs.conditioning.unsqueeze(2).unsqueeze(3).repeat({1, 1, height, width});
  camera.select(1, capture::kCyclesCondition).copy_(inputs.cycles);
  return torch::cat({inputs.groups.flatten(1, 2), camera}, 1);
}

torch::Tensor matrix(const std::vector<float>& values, int64_t rows, const torch::Tensor& like) {
  return torch::tensor(at::ArrayRef<float>(values)).reshape({rows, -1}).to(like);
}

}  // namespace

bool depends_on_patterns(const std::string& name) {
  return name.starts_with("stem.") || name.starts_with("pictures.") || name.starts_with("features.") ||
         name == "weigh.weight";
}

model::Weights weights_for_any_patterns(const model::Model& model) {
  model::Weights weights = model.weights;
  for (const auto& [name, shared] : model.any_patterns) weights[name] = shared.values;
  return weights;
}

Result<Apertures> describe_apertures(const std::vector<capture::Codes>& codes, torch::Device device) {
  Apertures result;
  std::vector<torch::Tensor> slots, moments, gains, weights, constants, offsets;
  for (const capture::Codes& each : codes) {
    E2LF_ASSIGN_OR_RETURN(const geometry::Aperture aperture, geometry::describe_aperture(each));
    const auto pictures = static_cast<int64_t>(aperture.pictures.size());
    std::vector<double> slot, moment, gain, weight, offset;
    std::vector<int64_t> transitions;
    for (const geometry::AperturePicture& picture : aperture.pictures) {
      slot.insert(slot.end(), picture.slots.begin(), picture.slots.end());
      moment.insert(moment.end(), picture.moments.begin(), picture.moments.end());
      gain.push_back(picture.gain);
      weight.push_back(picture.weight);
      offset.insert(offset.end(), {picture.offset_y, picture.offset_x});
      transitions.push_back(static_cast<int64_t>(picture.transition));
    }
    const auto lit = capture::codes_of_whole_cycle(each);
    result.lit = static_cast<int64_t>(lit ? lit->num_patterns : each.num_patterns) - 1;
    E2LF_REQUIRE(slots.empty() || transitions == result.transitions, "all samples have pictures in the same places");
    result.transitions = std::move(transitions);
    const auto tensor = [](const auto& values) {
      return torch::tensor(at::ArrayRef<double>(values.data(), values.size()), torch::kDouble);
    };
    slots.push_back(tensor(slot).reshape({pictures, kSlots}).t());
    moments.push_back(tensor(moment).reshape({pictures, kMoments}).t());
    gains.push_back(tensor(gain));
    weights.push_back(tensor(weight));
    constants.push_back(tensor(aperture.constants));
    offsets.push_back(tensor(offset).reshape({pictures, 2}));
  }
  const auto put = [&](const std::vector<torch::Tensor>& each) { return torch::stack(each).to(device, torch::kFloat); };
  result.slots = put(slots);
  result.moments = put(moments);
  result.gains = put(gains);
  result.weights = put(weights);
  result.constants = put(constants);
  result.offsets = torch::stack(offsets);
  return result;
}

Network depth_network(const std::vector<size_t>& widths, size_t num_inputs) {
  E2LF_REQUIRE(widths.size() >= 2, "the evidence is weighed at the second level");
  constexpr size_t kPictures = 3;
  Network network{num_inputs, {}};
  LayerList layers{network};
  layers.conv("stem", "input", widths[0], 2, 2);
  network.layers.back().relu = true;
  std::string x = layers.conv("start", "stem", widths[0], 3);
  layers.conv("pictures", "input", kPictures, kSweepScale, kSweepScale);
  layers.conv("features", "pictures", kPictures * kFeatures, 5);
  layers.add(
      {.name = "sweep",
       .op = geometry::GeometryOp::kPlaneSweep,
       .inputs = {"features"},
       .kernel = kWindow,
       .attributes = {{"disparities", compared_disparities()}, {"offsets", std::vector<double>(2 * kPictures, 0.0)}}});
  x = layers.levels(x, widths, {}, [&](const std::string& half) { return add_evidence(layers, half, widths[1]); });
  x = layers.conv("head", x, kHeadScale * kHeadScale * model::kDepthOutputs, 3);
  layers.add({.name = "output", .op = model::Op::kPixelShuffle, .inputs = {x}, .stride = kHeadScale});
  return network;
}

Network depth_network_of_moved_pictures(const std::vector<size_t>& widths) {
  Network network = depth_network(widths, model::kMovedPlanes);
  const auto head = std::ranges::find(network.layers, "head", &model::Layer::name);
  head->residual = kKept;
  network.layers.insert(head, {.name = kKept,
                               .inputs = {"input"},
                               .out_channels = head->out_channels,
                               .kernel = kHeadScale,
                               .stride = kHeadScale});
  const auto sweep = std::ranges::find(network.layers, "sweep", &model::Layer::name);
  std::vector<double>& offsets = sweep->attributes["offsets"];
  offsets.clear();
  for (const auto& place : geometry::kPlaces) {
    for (const double offset : place) offsets.push_back(offset / static_cast<double>(kSweepScale));
  }
  return network;
}

void begin_with_mean_of_disparities(model::Weights& weights) {
  for (const char* name : {"head.weight", "head.bias"}) {
    for (float& value : weights[name]) value *= 0.5F;
  }
  constexpr size_t kPixels = kHeadScale * kHeadScale, kOutputs = model::kDepthOutputs * kPixels;
  std::vector<float>& kept = weights[cat(kKept, ".weight")];
  kept.assign(kOutputs * model::kMovedPlanes * kPixels, 0.0F);
  for (size_t output = 0; output < kOutputs; ++output) {
    const size_t plane = geometry::kFirstDepthPlane + output / kPixels;
    kept[(output * model::kMovedPlanes + plane) * kPixels + output % kPixels] = 0.5F / geometry::kDepthScale;
  }
  weights[cat(kKept, ".bias")].assign(kOutputs, 0.0F);
}

DepthInputs form_depth_inputs(const torch::Tensor& events, const SampleConstants& constants,
                              const torch::Tensor& cycles, const std::vector<model::InputGroup>& groups) {
  const std::vector<model::InputGroup> of_counts(groups.begin(), groups.end() - 1);
  const float of_camera = groups.back().scale;
  return {form_inputs(events, of_counts, constants).unflatten(1, {static_cast<int64_t>(of_counts.size()), -1}),
          constants.conditioning * of_camera, torch::log2(cycles) * (capture::cycles_condition(2) * of_camera)};
}

AnyPatternsModule::AnyPatternsModule(const std::vector<size_t>& widths, torch::Device device)
    : module_((geometry::add_operations(), depth_network(widths, 1)), device, shapes_for_any_patterns(widths)) {}

/// The first layer: of the slots of each group, of the central intensity and its derivatives, and of constants.
torch::Tensor AnyPatternsModule::stem(const DepthInputs& inputs, const Apertures& apertures,
                                      const torch::Tensor& constants, torch::ScalarType compute,
                                      const NamedTensors& weights) const {
  constexpr int64_t kPlanes = kGroups * kSlots + kMoments;
  const auto slots = torch::matmul(apertures.slots.unsqueeze(1), inputs.groups.flatten(3));  // [batch, group, slot, yx]
  const auto moments =
      torch::matmul(apertures.moments * apertures.gains.unsqueeze(1), inputs.groups.select(1, kIntensities).flatten(2));
  const auto planes = torch::cat(
      {torch::cat({slots.flatten(1, 2), moments}, 1).unflatten(2, {inputs.groups.size(3), inputs.groups.size(4)}),
       inputs.cycles.unsqueeze(1)},
      1);
  const auto& weight = weights.at("stem.weight");
  const auto of_planes = torch::cat({weight.narrow(1, 0, kPlanes), weight.narrow(1, kPlanes + kConstants, 1)}, 1);
  const auto of_constants = weight.narrow(1, kPlanes, kConstants).sum({2, 3});
  const auto bias = weights.at("stem.bias") + torch::matmul(constants, of_constants.t());  // [batch, out]
  const auto x = at::conv2d(planes.to(compute), of_planes.to(compute), {}, 2);
  return torch::relu(x + bias.to(compute).unsqueeze(2).unsqueeze(3));
}

/// The features of each picture [batch, P, feature, y, x], which are made of it, of the one before, and of the mean of
/// all. What is linear in the inputs is made of each picture alone first, which needs a third of the memory.
torch::Tensor AnyPatternsModule::features(const DepthInputs& inputs, const torch::Tensor& constants,
                                          torch::ScalarType compute, const NamedTensors& weights) const {
  constexpr int64_t kPlanes = kGroups * kParts;
  const int64_t batch = inputs.groups.size(0), pictures = inputs.groups.size(2);
  const auto& weight = weights.at("pictures.weight");
  const auto kernel = weight.narrow(1, 0, kPlanes).reshape({kKinds * kParts, kGroups, kSweepScale, kSweepScale});
  const auto each =
      at::conv2d(inputs.groups.transpose(1, 2).flatten(0, 1).to(compute), kernel.to(compute), {}, kSweepScale);
  const auto parts =
      each.unflatten(1, {kKinds, kParts}).unflatten(0, {batch, pictures});  // [batch, P, kind, part, ...]
  const auto of_cycles = at::conv2d(inputs.cycles.unsqueeze(1).to(compute),
                                    weight.narrow(1, kPlanes + kConstants, 1).to(compute), {}, kSweepScale);
  const auto bias = weights.at("pictures.bias") +
                    torch::matmul(constants, weight.narrow(1, kPlanes, kConstants).sum({2, 3}).t());  // [batch, kind]
  const auto same = (of_cycles + bias.to(compute).unsqueeze(2).unsqueeze(3)).unsqueeze(1);
  const auto all = parts.select(3, 0) + neighbours(parts.select(3, 1)) + parts.select(3, 2).mean(1, true) + same;
  const auto made = of_its_kind(all).unsqueeze(2);  // [batch, P, 1, y, x]
  const auto with_others = torch::cat({made, neighbours(made), made.mean(1, true).expand_as(made)}, 2);
  const auto x = at::conv2d(with_others.flatten(0, 1), weights.at("features.weight").to(compute),
                            weights.at("features.bias").to(compute), 1, 2);
  return of_its_kind(x.unflatten(1, {kKinds, kFeatures}).unflatten(0, {batch, pictures}));
}

torch::Tensor AnyPatternsModule::forward(const DepthInputs& all, const Apertures& apertures, torch::ScalarType compute,
                                         const NamedTensors* weights, NamedTensors* input_means) const {
  if (weights == nullptr) weights = &module_.parameters();
  const auto device = all.groups.device();
  DepthInputs inputs = all;
  const auto count = static_cast<int64_t>(apertures.transitions.size());
  inputs.groups =
      all.groups.index_select(2, torch::tensor(at::ArrayRef<int64_t>(apertures.transitions), torch::kLong).to(device));
  constexpr int64_t kFixed = capture::kNumFixedConditions;
  auto transmissions = torch::zeros({inputs.groups.size(0), count}, torch::device(device));
  for (int64_t p = 0; p < count; ++p) {
    const int64_t transition = apertures.transitions[static_cast<size_t>(p)];
    if (transition == 0 || transition >= apertures.lit) continue;
    transmissions.select(1, p).copy_(all.conditioning.select(1, kFixed + transition - 1));
  }
  const auto of_slots = torch::matmul(apertures.slots, transmissions.unsqueeze(2)).squeeze(2);
  const auto constants = torch::cat({apertures.constants, of_slots, all.conditioning.narrow(1, 0, kFixed - 1)}, 1);

  const auto features = this->features(inputs, constants, compute, *weights).to(torch::kFloat);
  const auto scale = (apertures.weights * 3.0 / static_cast<double>(count)).sqrt();
  const auto compared = features * scale.unsqueeze(2).unsqueeze(3).unsqueeze(4);
  const auto sweep =
      sweep_planes(compared, apertures.offsets / static_cast<double>(kSweepScale), compared_disparities(), kWindow) *
      (2.0 / static_cast<double>(std::max<int64_t>(1, count - 1)));
  const auto maps = torch::cat({apertures.slots, apertures.moments}, 1);
  const auto details = torch::matmul(maps, features.flatten(2))
                           .unflatten(2, {kFeatures, features.size(3), features.size(4)})
                           .flatten(1, 2);
  const NamedTensors given = {{"stem", stem(inputs, apertures, constants, compute, *weights)},
                              {"pictures", details.to(compute)},  // none reads it
                              {"features", details.to(compute)},
                              {"sweep", sweep.to(compute)}};
  return module_.forward(inputs.cycles.unsqueeze(1), compute, weights, input_means, given);
}

void AnyPatternsModule::store(const NamedTensors& weights, model::Model& model) {
  for (const auto& [name, values] : to_weights(weights)) {
    if (!depends_on_patterns(name)) {
      model.weights[name] = values;
      continue;
    }
    const auto sizes = weights.at(name).sizes();
    model.any_patterns[name] = {{sizes.begin(), sizes.end()}, values};
  }
}

torch::Tensor moved_planes(const DepthInputs& inputs, const torch::Tensor& disparity,
                           const std::vector<model::MovedInput>& patterns) {
  const auto channels = all_channels(inputs);
  std::vector<torch::Tensor> planes;
  for (int64_t i = 0; i < channels.size(0); ++i) {
    const model::MovedInput& from = patterns[static_cast<size_t>(i)];
    const std::vector<int64_t> numbers(from.moved.begin(), from.moved.end());
    const auto own = channels.narrow(0, i, 1);
    NamedTensors values = {
        {"pictures", own.index_select(1, torch::tensor(at::ArrayRef<int64_t>(numbers), torch::kLong).to(own.device()))},
        {"disparity", disparity.narrow(0, i, 1)}};
    std::vector<torch::Tensor> known = {own};
    for (size_t place = 0; place < from.num_places(); ++place) {
      const std::vector<model::Layer> layers = model::moves_to_place(from, place, "pictures", "disparity");
      for (const model::Layer& layer : layers) {
        values[layer.name] = apply_warp({layer, {values.at(layer.inputs[0]), values.at(layer.inputs[1])}, nullptr});
      }
      known.push_back(values.at(layers.back().name));
    }
    known.push_back(values.at("disparity"));
    auto all = torch::cat(known, 1)[0].flatten(1);
    const auto apply = [&](const model::LinearStep& step) {
      const auto rows = static_cast<int64_t>(step.bias.size());
      return torch::addmm(matrix(step.bias, rows, all), matrix(step.weight, rows, all), all);
    };
    for (const model::LinearStep& step : from.rectified) all = torch::cat({all, torch::relu(apply(step))});
    planes.push_back(apply(from.planes).unflatten(1, {own.size(2), own.size(3)}));
  }
  return torch::stack(planes);
}

}  // namespace e2lf::learn
