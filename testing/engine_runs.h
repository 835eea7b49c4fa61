// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "e2lf/engine/engine.h"

namespace e2lf::engine {

/// Returns the output of a network for one image, on its own engine.
inline std::vector<float> run_engine(const model::Network& network, const model::Weights& weights,
                                     const std::vector<float>& input, size_t height, size_t width,
                                     Precision precision = Precision::kFloat32) {
  const Engine engine = Engine::create(network, weights, {precision}).value();
  const size_t channels = model::infer_shapes(network).value().back().channels;
  std::vector<float> output(channels * height * width, NAN);
  engine.run(input, height, width, output).value();
  return output;
}

/// Returns the largest difference, which is infinite if the sizes differ.
inline double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = a.size() == b.size() ? 0.0 : INFINITY;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double difference = std::abs(static_cast<double>(a[i]) - b[i]);
    largest = difference <= largest ? largest : difference;  // NaN takes precedence
  }
  return largest;
}

inline double root_mean_square(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace e2lf::engine
