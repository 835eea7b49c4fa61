// SPDX-License-Identifier: MIT
// Checks models, and states what their groups of input channels need; declared in model.h.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/model/model.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
namespace {

// These bounds keep products of sizes far from overflow.
constexpr size_t kMaxPatterns = 1024;
constexpr size_t kMaxViews = 255;

Error refuse(const std::string& location, const std::string& field, const std::string& message,
             ErrorCode code = ErrorCode::kInvalidValue) {
  return {code, message, cat(location, ": ", field)};
}

// Each function checks some fields of a model, and names the one that it rejects.

Result<void> check_sizes(const Model& model, const std::string& location) {
  const auto measurement = measurement_of(model.input);
  if (!measurement) return refuse(location, "input", measurement.error().message);
  // Events need a transition between two patterns.
  const size_t least = capture::has_events(*measurement) ? 2 : 1;
  if (model.num_patterns < least || model.num_patterns > kMaxPatterns) {
    return refuse(location, "num_patterns",
                  cat("the model has ", model.num_patterns, " patterns; use ", least, " to ", kMaxPatterns));
  }
  if (*measurement == capture::MeasurementKind::kLensArray && model.num_patterns != 1) {
    return refuse(location, "num_patterns", "a lens array requires an open aperture; state one pattern");
  }
  for (const auto& [field, views] : {std::pair("views_y", model.views_y), std::pair("views_x", model.views_x)}) {
    if (views < 1 || views > kMaxViews)
      return refuse(location, field, cat("the model has ", views, " views per axis; use 1 to ", kMaxViews));
  }
  return {};
}

Result<void> check_sensor(const Model& model, const std::string& location) {
  const auto known = choice_of(model.event_model, capture::kEventModels, "event model");
  if (!known) return refuse(location, "event_model", known.error().message);
  const capture::SensorConstants& constants = model.constants;
  const auto positive = [](float value) { return std::isfinite(value) && value > 0.0F; };
  if (!positive(constants.eps))
    return refuse(location, "constants.eps", cat(constants.eps, " is not above zero; correct it"));
  if (!positive(constants.tau))
    return refuse(location, "constants.tau", cat(constants.tau, " is not above zero; correct it"));
  for (const auto& [field, sigma] : {std::pair("sigma_w", constants.sigma_w), std::pair("sigma_z", constants.sigma_z),
                                     std::pair("sigma_i", constants.sigma_i)}) {
    if (!std::isfinite(sigma) || sigma < 0.0F) {
      return refuse(location, cat("constants.", field), cat(sigma, " is not a standard deviation; use zero or more"));
    }
  }
  return {};
}

Result<void> check_input(const Model& model, const std::string& location) {
  if (model.input.empty()) return refuse(location, "input", "the network has no input; give at least one group");
  for (size_t i = 0; i < model.input.size(); ++i) {
    const float scale = model.input[i].scale;
    if (!std::isfinite(scale) || scale == 0.0F) {
      return refuse(location, cat("input[", i, "].scale"),
                    cat(scale, " is not a scale; use a finite number other than zero"));
    }
  }
  return {};
}

Result<void> check_network(const Model& model, const std::string& location) {
  const auto shapes = infer_shapes(model.network);
  if (!shapes)
    return refuse(location, cat("network: ", shapes.error().location), shapes.error().message, shapes.error().code);
  if (is_recurrent(model.network)) {
    return refuse(location, "network",
                  "a layer depends on the previous frame, but light fields are independent; use other "
                  "layers, or a model of frames",
                  ErrorCode::kUnsupported);
  }
  const size_t inputs = num_input_channels(model.input, model.num_patterns);
  if (model.network.input_channels != inputs) {
    return refuse(location, "network.input_channels",
                  cat("the network has ", model.network.input_channels, " input channels, but ", model.input.size(),
                      " input groups for ", model.num_patterns, " patterns have ", inputs, "; make them equal"),
                  ErrorCode::kShape);
  }
  const LayerShape output = shapes->back();
  const size_t views = model.views_y * model.views_x;
  if ((output.channels != views && !is_depth_network(model)) || output.scale != 1) {
    return refuse(location, "network",
                  cat("the last layer has ", output.channels, " channels at scale ", output.scale, ", not ", views,
                      " views, or a disparity and its scale, at scale 1; correct the last layer"),
                  ErrorCode::kShape);
  }
  return {};
}

Result<void> check_codes(const Model& model, const std::string& location) {
  if (!model.codes) return {};
  const capture::Codes& codes = *model.codes;
  E2LF_RETURN_IF_ERROR(capture::validate(codes, cat(location, ": aperture.codes")));
  const std::vector<size_t> found = {codes.num_patterns, codes.views_y, codes.views_x};
  const std::vector<size_t> expected = {model.num_patterns, model.views_y, model.views_x};
  if (found != expected) {
    return refuse(location, "aperture.codes",
                  cat("the codes have shape ", shape_text(found), ", but the model requires ", shape_text(expected),
                      "; give the patterns of this model"),
                  ErrorCode::kShape);
  }
  if (model.black_first != capture::is_black_first(codes)) {
    return refuse(location, "black_first",
                  cat("black_first is ", model.black_first ? "true" : "false", ", but the first pattern is ",
                      model.black_first ? "not " : "", "black; make them agree"));
  }
  return {};
}

Result<void> check_any_patterns(const Model& model, const std::string& location) {
  for (const auto& [name, weights] : model.any_patterns) {
    const size_t size = std::accumulate(weights.shape.begin(), weights.shape.end(), size_t{1}, std::multiplies());
    const bool is_finite = std::ranges::all_of(weights.values, [](float value) { return std::isfinite(value); });
    if (size == weights.values.size() && is_finite) continue;
    return refuse(location, cat("any.", name), "the weights are not finite or have another size; store them again");
  }
  return {};
}

}  // namespace

Result<void> validate_weights(const Network& network, const Weights& weights, const std::string& location) {
  const std::vector<WeightShape> wanted = weight_shapes(network);
  for (const WeightShape& tensor : wanted) {
    const auto found = weights.find(tensor.name);
    if (found == weights.end()) {
      return refuse(location, tensor.name, "the weights are missing; give one tensor for each layer",
                    ErrorCode::kNotFound);
    }
    const std::vector<float>& values = found->second;
    if (values.size() != tensor.size()) {
      return refuse(location, tensor.name,
                    cat("there are ", values.size(), " weights, but the shape ", shape_text(tensor.shape), " requires ",
                        tensor.size(), "; give the weights of this network"),
                    ErrorCode::kShape);
    }
    const auto bad = std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
    if (bad != values.end()) {
      return refuse(location, tensor.name,
                    cat("weight ", bad - values.begin(), " is ", *bad, "; train or import it again"),
                    ErrorCode::kInvalidValue);
    }
  }
  const auto is_extra = [&](const auto& entry) {
    return std::none_of(wanted.begin(), wanted.end(), [&](const auto& tensor) { return tensor.name == entry.first; });
  };
  const auto extra = std::find_if(weights.begin(), weights.end(), is_extra);
  if (extra == weights.end()) return {};
  return refuse(location, extra->first, "the weights belong to no layer of the network; remove them",
                ErrorCode::kFormat);
}

Result<void> validate(const Model& model, const std::string& location) {
  for (const auto check : {check_sizes, check_sensor, check_input, check_network, check_codes}) {
    E2LF_RETURN_IF_ERROR(check(model, location));
  }
  E2LF_RETURN_IF_ERROR(validate_weights(model.network, model.weights, location));
  E2LF_RETURN_IF_ERROR(check_any_patterns(model, location));
  if (model.open_guide) {
    return refuse(location, "composed_of",
                  "the network is for any patterns; give those that the camera shows, or adapt it to them with `"
                  "e2lf model store`",
                  ErrorCode::kUnsupported)
        .about("codes");
  }
  if (model.provenance.is_object()) return {};
  return refuse(location, "provenance", "the provenance is not a JSON object; enclose it in { }");
}

bool is_depth_network(const Model& model) {
  const auto shapes = infer_shapes(model.network);
  return shapes && shapes->back().channels == kDepthOutputs && model.views_y * model.views_x != kDepthOutputs;
}

size_t num_input_channels(InputKind kind, size_t num_patterns) {
  switch (kind) {
    case InputKind::kCounts:
    case InputKind::kCumulative:
    case InputKind::kLevel:
    case InputKind::kIntensity:
      return num_patterns - 1;
    case InputKind::kCamera:
      return capture::conditioning_size(num_patterns);
    case InputKind::kImages:
      return num_patterns;
    case InputKind::kImageSum:
      return 1;
    case InputKind::kLensArray:
      return capture::kLensPixels * capture::kLensPixels;
    case InputKind::kMoved:
      return kMovedPlanes;
  }
  return 0;
}

size_t num_input_channels(const std::vector<InputGroup>& groups, size_t num_patterns) {
  size_t channels = 0;
  for (const InputGroup& group : groups) channels += num_input_channels(group.kind, num_patterns);
  return channels;
}

Result<capture::MeasurementKind> measurement_of(const std::vector<InputGroup>& groups) {
  const auto has = [&](InputKind kind) {
    return std::any_of(groups.begin(), groups.end(), [kind](const InputGroup& group) { return group.kind == kind; });
  };
  const bool has_events = std::any_of(groups.begin(), groups.end(), [](const InputGroup& group) {
    return is_of_counts(group) || group.kind == InputKind::kCamera;
  });
  const bool has_images = has(InputKind::kImages), has_sum = has(InputKind::kImageSum),
             has_lenses = has(InputKind::kLensArray);
  using capture::MeasurementKind;
  if (!has_images && !has_lenses) return has_sum ? MeasurementKind::kHybrid : MeasurementKind::kEventImages;
  if (has_images && !has_events && !has_sum && !has_lenses) return MeasurementKind::kCodedImages;
  if (has_lenses && !has_events && !has_sum && !has_images) return MeasurementKind::kLensArray;
  return fail(ErrorCode::kInvalidValue, "input",
              "no measurement provides all of these inputs; use only images, only lens-array, or only inputs from "
              "events with or without "
              "image-sum");
}

bool is_conditioned_on_camera(const Model& model) {
  return std::any_of(model.input.begin(), model.input.end(), [](const InputGroup& group) {
    return group.kind == InputKind::kCamera || group.kind == InputKind::kMoved;
  });
}

bool reads_moved_pictures(const Model& model) {
  return model.input.size() == 1 && model.input[0].kind == InputKind::kMoved;
}

}  // namespace e2lf::model
