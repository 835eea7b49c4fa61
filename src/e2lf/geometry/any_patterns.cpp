// SPDX-License-Identifier: MIT
#include "e2lf/geometry/any_patterns.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

#include "e2lf/base/text.h"
#include "e2lf/geometry/aperture.h"
#include "e2lf/geometry/operations.h"

namespace e2lf::geometry {
namespace {

constexpr size_t kGroups = 3;       // of inputs: cumulative counts, levels, intensities
constexpr size_t kIntensities = 2;  // the last group
constexpr size_t kMoments = 3;      // the central picture and its derivatives
constexpr size_t kParts = 3;        // of what a picture is compared with: itself, its neighbour, the mean of all
constexpr size_t kKinds = kSlots;   // of pictures that have weights of their own
/// What is the same at all pixels of the first layers: of the patterns, transmissions of the slots, and of the sensor.
constexpr size_t kConstants = kApertureConstants + kSlots + capture::kNumFixedConditions;
constexpr const char* kHalf = "half_";

const model::SharedWeights* find(const model::Model& model, const std::string& name) {
  const auto found = model.any_patterns.find(name);
  return found == model.any_patterns.end() ? nullptr : &found->second;
}

/// The shapes of the weights for any patterns, by the sizes of the layers.
struct Sizes {
  size_t stem = 0, weigh = 0, features = 0, planes = 0;  ///< channels; those of one picture; disparities
  size_t stem_kernel = 0, pictures_kernel = 0, features_kernel = 0, weigh_kernel = 0;
};

const model::Layer* layer_named(const model::Network& network, const std::string& name) {
  const auto found = std::ranges::find(network.layers, name, &model::Layer::name);
  return found == network.layers.end() ? nullptr : &*found;
}

/// Returns the sizes of the layers, or nothing if one is missing.
std::optional<Sizes> sizes_of(const model::Model& model) {
  const auto* const features = find(model, "features.weight");
  const model::Layer *stem = layer_named(model.network, "stem"), *pictures = layer_named(model.network, "pictures"),
                     *of_features = layer_named(model.network, "features"),
                     *sweep = layer_named(model.network, "sweep"), *weigh = layer_named(model.network, "weigh");
  if (!features || features->shape.empty() || !stem || !pictures || !of_features || !sweep || !weigh) return {};
  const auto disparities = sweep->attributes.find("disparities");
  if (disparities == sweep->attributes.end()) return {};
  return Sizes{.stem = stem->out_channels,
               .weigh = weigh->out_channels,
               .features = features->shape[0] / kKinds,
               .planes = disparities->second.size(),
               .stem_kernel = stem->kernel,
               .pictures_kernel = pictures->kernel,
               .features_kernel = of_features->kernel,
               .weigh_kernel = weigh->kernel};
}

Result<void> check_shapes(const model::Model& model, const Sizes& sizes) {
  const auto square = [](size_t out, size_t in, size_t kernel) { return std::vector{out, in, kernel, kernel}; };
  const std::pair<std::string, std::vector<size_t>> wanted[] = {
      {"stem.weight", square(sizes.stem, kGroups * kSlots + kMoments + kConstants, sizes.stem_kernel)},
      {"stem.bias", {sizes.stem}},
      {"pictures.weight", square(kKinds, kGroups * kParts + kConstants, sizes.pictures_kernel)},
      {"pictures.bias", {kKinds}},
      {"features.weight", square(kKinds * sizes.features, kParts, sizes.features_kernel)},
      {"features.bias", {kKinds * sizes.features}},
      {"weigh.weight",
       square(sizes.weigh, sizes.weigh + sizes.planes + (kSlots + kMoments) * sizes.features, sizes.weigh_kernel)}};
  for (const auto& [name, shape] : wanted) {
    const model::SharedWeights* const weights = find(model, name);
    if (!weights || weights->shape != shape) {
      return fail(ErrorCode::kShape, cat(model.name, ": ", name), "the weights for any patterns must have shape ",
                  shape_text(shape), "; store those of this network");
    }
  }
  return {};
}

/// The weights [out, in, size] of a convolution that are filled one input at a time.
struct Kernels {
  size_t in = 0, size = 0;
  std::vector<float> values;

  Kernels(size_t out, size_t in_, size_t size_) : in(in_), size(size_), values(out * in_ * size_) {}
  void add(size_t o, size_t i, std::span<const float> kernel, double factor) {
    float* const to = values.data() + (o * in + i) * size;
    for (size_t k = 0; k < size; ++k) to[k] += static_cast<float>(factor * kernel[k]);
  }
};

/// Reads the kernels [out, in, y, x] of weights for any patterns.
class KernelReader {
 public:
  explicit KernelReader(const model::SharedWeights& weights)
      : values_(weights.values), in_(weights.shape[1]), size_(weights.shape[2] * weights.shape[3]) {}
  [[nodiscard]] std::span<const float> at(size_t o, size_t i) const {
    return values_.subspan((o * in_ + i) * size_, size_);
  }
  [[nodiscard]] double sum(size_t o, size_t i) const {
    double total = 0;
    for (const float value : at(o, i)) total += value;
    return total;
  }

 private:
  std::span<const float> values_;
  size_t in_, size_;
};

/// Adapts the weights of one network.
class Adapter {
 public:
  Adapter(const model::Model& any, const Sizes& sizes, const Aperture& aperture, const capture::Codes& codes)
      : any_(any),
        sizes_(sizes),
        pictures_(aperture.pictures),
        constants_(aperture.constants),
        transitions_(codes.num_patterns - 1) {
    const auto lit = capture::codes_of_whole_cycle(codes);
    lit_ = lit ? lit->num_patterns - 1 : transitions_;
  }

  /// The first layer: the slots, the central picture and its derivatives, and what is the same at all pixels.
  void adapt_stem(const std::string& prefix, model::Weights& weights) const {
    const KernelReader from(*find(any_, "stem.weight"));
    Kernels to(sizes_.stem, num_inputs(), sizes_.stem_kernel * sizes_.stem_kernel);
    std::vector<float> bias = find(any_, "stem.bias")->values;
    for (size_t o = 0; o < sizes_.stem; ++o) {
      for (const AperturePicture& picture : pictures_) {
        for (size_t group = 0; group < kGroups; ++group) {
          for (size_t slot = 0; slot < kSlots; ++slot) {
            to.add(o, input_of(group, picture), from.at(o, group * kSlots + slot), picture.slots[slot]);
          }
        }
        for (size_t i = 0; i < kMoments; ++i) {
          to.add(o, input_of(kIntensities, picture), from.at(o, kGroups * kSlots + i),
                 picture.moments[i] * picture.gain);
        }
      }
      add_constants(from, o, kGroups * kSlots + kMoments, o, to, bias);
    }
    weights[prefix + "stem.weight"] = std::move(to.values);
    weights[prefix + "stem.bias"] = std::move(bias);
  }

  /// The pictures of which features are made: each from itself, its neighbour, and the mean of all.
  void adapt_pictures(const std::string& prefix, model::Weights& weights) const {
    const KernelReader from(*find(any_, "pictures.weight"));
    const std::vector<float>& of_kind = find(any_, "pictures.bias")->values;
    Kernels to(pictures_.size(), num_inputs(), sizes_.pictures_kernel * sizes_.pictures_kernel);
    std::vector<float> bias(pictures_.size());
    for (size_t p = 0; p < pictures_.size(); ++p) {
      const size_t kind = kind_of(p);
      bias[p] = of_kind[kind];
      for_parts(p, [&](size_t part, size_t q, double share) {
        for (size_t group = 0; group < kGroups; ++group) {
          to.add(p, input_of(group, pictures_[q]), from.at(kind, part * kGroups + group), share);
        }
      });
      add_constants(from, kind, kGroups * kParts, p, to, bias);
    }
    weights[prefix + "pictures.weight"] = std::move(to.values);
    weights[prefix + "pictures.bias"] = std::move(bias);
  }

  /// The features of each picture, scaled as plane-sweep is to weigh them.
  void adapt_features(const std::string& prefix, model::Weights& weights) const {
    const KernelReader from(*find(any_, "features.weight"));
    const std::vector<float>& of_kind = find(any_, "features.bias")->values;
    Kernels to(pictures_.size() * sizes_.features, pictures_.size(), sizes_.features_kernel * sizes_.features_kernel);
    std::vector<float> bias(pictures_.size() * sizes_.features);
    for (size_t p = 0; p < pictures_.size(); ++p) {
      for (size_t f = 0; f < sizes_.features; ++f) {
        const size_t o = p * sizes_.features + f, kind = kind_of(p) * sizes_.features + f;
        bias[o] = static_cast<float>(sweep_scale(p) * of_kind[kind]);
        for_parts(
            p, [&](size_t part, size_t q, double share) { to.add(o, q, from.at(kind, part), share * sweep_scale(p)); });
      }
    }
    weights[prefix + "features.weight"] = std::move(to.values);
    weights[prefix + "features.bias"] = std::move(bias);
  }

  /// The layer that weighs the results of plane-sweep and the details of the pictures.
  void adapt_weigh(const std::string& prefix, model::Weights& weights) const {
    const KernelReader from(*find(any_, "weigh.weight"));
    const size_t before = sizes_.weigh, details = before + sizes_.planes;
    Kernels to(sizes_.weigh, details + pictures_.size() * sizes_.features, sizes_.weigh_kernel * sizes_.weigh_kernel);
    const double of_pairs = 2 / std::max(1.0, static_cast<double>(pictures_.size()) - 1);
    for (size_t o = 0; o < sizes_.weigh; ++o) {
      for (size_t i = 0; i < details; ++i) to.add(o, i, from.at(o, i), i < before ? 1 : of_pairs);
      for (size_t p = 0; p < pictures_.size(); ++p) {
        for (size_t f = 0; f < sizes_.features; ++f) {
          const auto add = [&](size_t map, double share) {
            to.add(o, details + p * sizes_.features + f, from.at(o, details + map * sizes_.features + f),
                   share / sweep_scale(p));
          };
          for (size_t slot = 0; slot < kSlots; ++slot) add(slot, pictures_[p].slots[slot]);
          for (size_t i = 0; i < kMoments; ++i) add(kSlots + i, pictures_[p].moments[i]);
        }
      }
    }
    weights[prefix + "weigh.weight"] = std::move(to.values);
  }

  /// The mean over 2x2 pixels, which is like one over four cycles.
  void adapt_half_input(model::Weights& weights) const {
    Kernels to(num_inputs(), num_inputs(), 4);
    const std::vector<float> ones(4, 1.0F);
    for (size_t i = 0; i < num_inputs(); ++i) to.add(i, i, ones, 0.25);
    std::vector<float> bias(num_inputs());
    bias[kGroups * transitions_ + capture::kCyclesCondition] = capture::cycles_condition(4);
    weights[std::string(kHalf) + "input.weight"] = std::move(to.values);
    weights[std::string(kHalf) + "input.bias"] = std::move(bias);
  }

  [[nodiscard]] size_t num_inputs() const {
    return kGroups * transitions_ + capture::conditioning_size(transitions_ + 1);
  }

 private:
  /// The first picture follows the black pattern, the second one has another picture before it.
  static size_t kind_of(size_t picture) { return std::min(picture, kKinds - 1); }

  [[nodiscard]] size_t input_of(size_t group, const AperturePicture& picture) const {
    return group * transitions_ + picture.transition;
  }

  [[nodiscard]] double sweep_scale(size_t picture) const {
    return std::sqrt(pictures_[picture].weight * 3 / static_cast<double>(pictures_.size()));
  }

  /// Calls `add(part, picture, share)` for each picture of which the parts of picture p are made.
  template <typename Add>
  void for_parts(size_t p, const Add& add) const {
    add(0, p, 1.0);
    add(1, p > 0 ? p - 1 : 1, 1.0);
    for (size_t q = 0; q < pictures_.size(); ++q) add(2, q, 1 / static_cast<double>(pictures_.size()));
  }

  /// Adds to output `o` what is the same at all pixels, whose kernels begin at input `first`.
  void add_constants(const KernelReader& from, size_t from_out, size_t first, size_t o, Kernels& to,
                     std::vector<float>& bias) const {
    for (size_t i = 0; i < kApertureConstants; ++i) {
      bias[o] += static_cast<float>(constants_[i] * from.sum(from_out, first + i));
    }
    first += kApertureConstants;
    const size_t conditions = kGroups * transitions_, transmissions = conditions + capture::kNumFixedConditions;
    for (const AperturePicture& p : pictures_) {
      if (p.transition == 0 || p.transition >= lit_) continue;
      for (size_t slot = 0; slot < kSlots; ++slot) {
        to.add(o, transmissions + p.transition - 1, from.at(from_out, first + slot), p.slots[slot]);
      }
    }
    first += kSlots;
    for (size_t i = 0; i < capture::kNumFixedConditions; ++i) {
      to.add(o, conditions + i, from.at(from_out, first + i), 1);
    }
  }

  const model::Model& any_;
  const Sizes& sizes_;
  const std::vector<AperturePicture>& pictures_;
  const std::array<double, kApertureConstants>& constants_;
  size_t transitions_ = 0, lit_ = 0;
};

/// Gives plane-sweep the places of the pictures, which it reads at the resolution of `step` pixels.
void place_pictures(const Aperture& aperture, size_t step, model::Layer& sweep) {
  std::vector<double>& offsets = sweep.attributes["offsets"];
  offsets.clear();
  for (const AperturePicture& picture : aperture.pictures) {
    offsets.push_back(picture.offset_y / static_cast<double>(step));
    offsets.push_back(picture.offset_x / static_cast<double>(step));
  }
}

/// Gives the layers the sizes of these patterns, and plane-sweep the places of the pictures.
void adapt_layers(const Aperture& aperture, const Sizes& sizes, size_t num_inputs, model::Network& network) {
  network.input_channels = num_inputs;
  for (const std::string prefix : {"", kHalf}) {
    for (model::Layer& layer : network.layers) {
      if (layer.name == prefix + "pictures") layer.out_channels = aperture.pictures.size();
      if (layer.name == prefix + "features") layer.out_channels = aperture.pictures.size() * sizes.features;
      if (layer.name == cat(kHalf, "input")) layer.out_channels = num_inputs;
      if (layer.name == prefix + "sweep") place_pictures(aperture, layer_named(network, "pictures")->stride, layer);
    }
  }
}

/// Returns a network of disparity for fixed patterns whose plane-sweep compares the pictures at the places of others.
Result<model::Model> at_places_of(const capture::Codes& codes, model::Model disparity) {
  E2LF_ASSIGN_OR_RETURN(const Aperture aperture, describe_aperture(codes));
  const model::Layer* const pictures = layer_named(disparity.network, "pictures");
  bool fits = pictures && disparity.num_patterns == codes.num_patterns;
  for (model::Layer& layer : disparity.network.layers) {
    if (!fits || layer.op != "plane-sweep") continue;
    fits = layer.attributes["offsets"].size() == 2 * aperture.pictures.size();
    if (fits) place_pictures(aperture, pictures->stride, layer);
  }
  if (!fits) {
    return fail(ErrorCode::kShape, disparity.name,
                "it compares another number of pictures than these patterns show; use another model");
  }
  disparity.codes = codes;
  return disparity;
}

bool has_inputs_of_any_patterns(const model::Model& model) {
  constexpr model::InputKind kExpected[] = {model::InputKind::kCumulative, model::InputKind::kLevel,
                                            model::InputKind::kIntensity, model::InputKind::kCamera};
  return std::ranges::equal(model.input, kExpected, {}, &model::InputGroup::kind);
}

/// Adapts the network of disparity that moves the pictures that a network reads.
Result<model::Model> moved_for_patterns(const model::Model& network, const capture::Codes& codes) {
  E2LF_ASSIGN_OR_RETURN(model::Model disparity, for_patterns(network.open_guide->disparity, codes));
  if (model::is_depth_network(network) && capture::codes_of_whole_cycle(codes)) return disparity;
  return composed_for_patterns(network, std::move(disparity), codes);
}

/// Adapts the network of disparity that views follow.
Result<model::Model> guided_for_patterns(const model::Model& views, const capture::Codes& codes) {
  if (views.codes.value_or(codes) != codes || views.num_patterns != codes.num_patterns) {
    return fail(ErrorCode::kInvalidValue, views.name, "its views were trained for other patterns; use another model");
  }
  const model::Model& guide = views.open_guide->disparity;
  E2LF_ASSIGN_OR_RETURN(model::Model disparity,
                        model::is_for_any_patterns(guide) ? for_patterns(guide, codes) : at_places_of(codes, guide));
  model::Model followers = views;
  followers.open_guide = nullptr;
  followers.codes = codes;
  followers.black_first = capture::is_black_first(codes);
  E2LF_ASSIGN_OR_RETURN(model::Model result,
                        guided(std::move(followers), std::move(disparity), views.open_guide->guide));
  result.precision_loss = views.precision_loss;
  return result;
}

}  // namespace

Result<model::Model> for_patterns(const model::Model& model, const capture::Codes& codes) {
  if (model::reads_moved_pictures(model) && model.open_guide) return moved_for_patterns(model, codes);
  if (model.open_guide) return guided_for_patterns(model, codes);
  if (!model::is_for_any_patterns(model)) {
    return fail(ErrorCode::kUnsupported, "", model.name,
                " was trained for its own patterns; give one for any patterns");
  }
  const std::optional<Sizes> sizes = sizes_of(model);
  if (!sizes || !has_inputs_of_any_patterns(model)) {
    return fail(ErrorCode::kShape, model.name,
                "the layers or inputs that depend on the patterns are not those that e2lf adapts; store it again");
  }
  E2LF_RETURN_IF_ERROR(check_shapes(model, *sizes));
  E2LF_ASSIGN_OR_RETURN(const Aperture aperture, describe_aperture(codes));
  model::Model adapted = model;
  adapted.num_patterns = codes.num_patterns;
  adapted.views_y = codes.views_y;
  adapted.views_x = codes.views_x;
  adapted.codes = codes;
  adapted.is_adapted = true;
  const Adapter adapter(model, *sizes, aperture, codes);
  adapt_layers(aperture, *sizes, adapter.num_inputs(), adapted.network);
  const bool has_half = layer_named(model.network, cat(kHalf, "stem")) != nullptr;
  const std::vector<std::string> prefixes =
      has_half ? std::vector<std::string>{"", kHalf} : std::vector<std::string>{""};
  for (const std::string& prefix : prefixes) {
    adapter.adapt_stem(prefix, adapted.weights);
    adapter.adapt_pictures(prefix, adapted.weights);
    adapter.adapt_features(prefix, adapted.weights);
    adapter.adapt_weigh(prefix, adapted.weights);
  }
  if (has_half) adapter.adapt_half_input(adapted.weights);
  E2LF_RETURN_IF_ERROR(model::validate(adapted, model.name));
  return adapted;
}

Result<model::Model> for_own_patterns(model::Model model) {
  if (!model.open_guide || !model.codes) return model;
  return for_patterns(model, *model.codes);
}

void add_operations() {
  static std::once_flag once;
  std::call_once(once, [] {
    for (const engine::Operation& operation : {plane_sweep(), render_layers(), warp()})
      engine::add_operation(operation);
  });
}

}  // namespace e2lf::geometry
