// SPDX-License-Identifier: MIT
// A small network of disparity for any patterns, patterns, and inputs.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "e2lf/geometry/operations.h"
#include "e2lf/model/model.h"
#include "testing/test_networks.h"

namespace e2lf::geometry::for_any_patterns {

using capture::Codes;
using engine::conv, engine::reshape;
using model::Layer;

inline constexpr size_t kSize = 32;  // height and width of the images, px

struct Box {
  size_t top, bottom, left, right;
  float value = 1;
};

inline void open_cells(const Box& box, size_t n, Codes& codes) {
  for (size_t y = box.top; y < box.bottom; ++y) {
    for (size_t x = box.left; x < box.right; ++x) codes.pattern(n)[y * 8 + x] = box.value;
  }
}

inline constexpr Box kFirst = {1, 4, 1, 4}, kSecond = {1, 5, 4, 8}, kThird = {5, 8, 3, 6};

/// Black, two boxes, black again, and a pattern of two grey boxes.
inline Codes with_black_and_grey() {
  Codes codes(5, 8, 8);
  open_cells(kFirst, 1, codes);
  open_cells(kSecond, 2, codes);
  open_cells({1, 4, 1, 4, 0.5F}, 4, codes);
  open_cells({5, 7, 2, 4, 0.25F}, 4, codes);
  return codes;
}

inline Codes three_boxes() {
  Codes codes(4, 8, 8);
  open_cells(kFirst, 1, codes);
  open_cells(kSecond, 2, codes);
  open_cells(kThird, 3, codes);
  return codes;
}

inline Layer transposed(const std::string& name, const std::string& input, size_t out_channels) {
  Layer layer = conv(name, input, out_channels, 2, false, "", 2);
  layer.op = GeometryOp::kConvTransposed;
  return layer;
}

/// The layers of e2lf-depth with one level of 4 and 6 channels.
inline model::Network small_network(size_t input_channels) {
  Layer sweep = reshape("sweep", GeometryOp::kPlaneSweep, {"features"});
  sweep.kernel = 7;
  for (int i = -17; i <= 17; ++i) sweep.attributes["disparities"].push_back(0.2 * i);
  sweep.attributes["offsets"] = {0, 0, 0, 0, 0, 0};
  return {input_channels,
          {conv("stem", "input", 4, 2, true, "", 2), conv("start", "stem", 4, 3, false),
           conv("pictures", "input", 3, 4, false, "", 4), conv("features", "pictures", 12, 5, false), sweep,
           conv("down0_0a", "start", 4, 3, true), conv("down0_0b", "down0_0a", 4, 3, false, "start"),
           conv("down0_half", "down0_0b", 6, 2, false, "", 2),
           reshape("evidence", GeometryOp::kConcat, {"down0_half", "sweep", "features"}),
           conv("weigh", "evidence", 6, 3, false, "down0_half"), conv("middle_0a", "weigh", 6, 3, true),
           conv("middle_0b", "middle_0a", 6, 3, false, "weigh"), transposed("up0_double", "middle_0b", 4),
           reshape("up0_join", GeometryOp::kAdd, {"up0_double", "down0_0b"}), conv("up0_0a", "up0_join", 4, 3, true),
           conv("up0_0b", "up0_0a", 4, 3, false, "up0_join"), conv("head", "up0_0b", 8, 3, false),
           reshape("disparity", GeometryOp::kPixelShuffle, {"head"}, 2)}};
}

/// The numbers (29 i + 13 n) mod 31, from -1 to 1, over the square root of the number of weights of an output.
inline std::vector<float> numbered(const std::string& name, const std::vector<size_t>& shape) {
  size_t number = 1;
  for (const size_t extent : shape) number *= extent;
  const size_t outputs = name == "up0_double.weight" ? number / shape[0] : shape[0];
  const double scale = std::sqrt(name.ends_with(".bias") ? 16.0 : static_cast<double>(number / outputs));
  std::vector<float> values;
  for (size_t i = 0; i < number; ++i) {
    values.push_back(static_cast<float>((static_cast<double>((29 * i + 13 * number) % 31) / 15.5 - 1) / scale));
  }
  return values;
}

inline model::Model small_model() {
  add_operations();
  model::Model model;
  model.name = "small";
  model.num_patterns = 4;
  model.codes = three_boxes();
  model.camera.emplace();
  model.input = {{model::InputKind::kCumulative, 0.125F},
                 {model::InputKind::kLevel, 0.125F},
                 {model::InputKind::kIntensity, 4.0F},
                 {model::InputKind::kCamera, 1.0F}};
  model.network = small_network(model::num_input_channels(model.input, 4));
  for (const auto& weights : model::weight_shapes(model.network)) {
    model.weights[weights.name] = numbered(weights.name, weights.shape);
  }
  const std::pair<std::string, std::vector<size_t>> shared[] = {
      {"stem.weight", {4, 48, 2, 2}},     {"stem.bias", {4}},
      {"pictures.weight", {3, 45, 4, 4}}, {"pictures.bias", {3}},
      {"features.weight", {12, 3, 5, 5}}, {"features.bias", {12}},
      {"weigh.weight", {6, 65, 3, 3}}};
  for (const auto& [name, shape] : shared) model.any_patterns[name] = {shape, numbered(name, shape)};
  return model;
}

/// Inputs for `transitions` event images: the numbers (31 c + 17 y + 7 x) mod 23 from -1 to 1, and conditions.
inline std::vector<float> inputs(size_t transitions) {
  std::vector<float> values;
  for (size_t c = 0; c < 3 * transitions; ++c) {
    for (size_t i = 0; i < kSize * kSize; ++i) {
      values.push_back(static_cast<float>((c * 31 + i / kSize * 17 + i % kSize * 7) % 23) / 11.5F - 1);
    }
  }
  const auto add_plane = [&](double value) { values.insert(values.end(), kSize * kSize, static_cast<float>(value)); };
  for (size_t c = 0; c < 15; ++c) add_plane((static_cast<double>(7 * c % 5) - 2) * 0.2);
  add_plane(0.25);  // two cycles
  for (size_t k = 1; k < transitions; ++k) add_plane(0.1 * static_cast<double>(k));
  return values;
}

}  // namespace e2lf::geometry::for_any_patterns
