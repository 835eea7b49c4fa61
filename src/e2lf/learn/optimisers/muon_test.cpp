// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/model/network.h"

namespace e2lf::learn {
namespace {

/// What a singular value of a matrix of norm 1 becomes.
double expected_singular_value(double s) {
  for (int i = 0; i < 5; ++i) s = 3.4445 * s - 4.7750 * std::pow(s, 3) + 2.0315 * std::pow(s, 5);
  return s;
}

/// A matrix with orthonormal columns.
torch::Tensor orthonormal(int64_t rows, int64_t columns) {
  return std::get<0>(torch::linalg_qr(torch::randn({rows, columns})));
}

TEST(Orthogonalise, KeepsSingularVectorsAndMapsSingularValues) {
  torch::manual_seed(3);
  const std::vector<float> values = {0.9F, 0.4F, 0.15F, 0.08F, 0.02F};
  const auto s = torch::tensor(values);
  const double norm = s.norm().item<double>();
  auto mapped = torch::empty({5});
  for (int64_t i = 0; i < 5; ++i) {
    mapped[i] = expected_singular_value(static_cast<double>(values[static_cast<size_t>(i)]) / norm);
    EXPECT_GT(mapped[i].item<double>(), 0.65);
    EXPECT_LT(mapped[i].item<double>(), 1.25);
  }
  const auto u = orthonormal(37, 5), v = orthonormal(11, 5);
  const auto matrix = u.matmul(s.diag()).matmul(v.t()) * 7.0;
  const auto expected = u.matmul(mapped.diag()).matmul(v.t());
  EXPECT_TRUE(torch::allclose(orthogonalise(matrix), expected, 1e-3, 1e-3));
  EXPECT_TRUE(torch::allclose(orthogonalise(matrix.t()), expected.t(), 1e-3, 1e-3));
  EXPECT_TRUE(torch::equal(orthogonalise(torch::zeros({4, 3})), torch::zeros({4, 3})));
  // Of a layer without active units: squares of its gradients underflow.
  EXPECT_LT(orthogonalise(matrix * 1e-22).abs().max().item<double>(), 1e-10);
}

TEST(Muon, MovesWeightsAgainstTheirGradientByStepsOfTheSizeOfAdams) {
  torch::manual_seed(4);
  for (const auto& sizes : {std::vector<int64_t>{8, 6, 3, 3}, std::vector<int64_t>{6, 8, 2, 2}}) {
    const auto start = torch::randn(sizes);
    const NamedTensors weights = {{"w", start.clone().set_requires_grad(true)}};
    const auto gradient = torch::randn(sizes) * 1e-4;
    weights.at("w").mutable_grad() = gradient;
    Muon muon(weights);
    muon.update(weights, 0.01);
    const auto step = (weights.at("w").detach() - start) / 0.01;
    EXPECT_LT((step * gradient).sum().item<double>(), 0.0);
    EXPECT_NEAR(step.square().mean().sqrt().item<double>(), 0.2, 0.06);
    EXPECT_TRUE(torch::allclose(muon.momenta().at("w"), 0.05 * gradient, 1e-4, 0.0));
  }
}

TEST(MuonWeights, AreThoseOfTheLargerConvolutionsButTheLast) {
  const NetworkModule network(model::unet({.widths = {8, 8}, .blocks = {1, 1}, .head_width = 4}), torch::kCPU);
  const auto weights = muon_weights(network);
  EXPECT_TRUE(weights.contains("stem.weight"));
  EXPECT_TRUE(weights.contains("up0_double.weight"));
  EXPECT_FALSE(weights.contains("skip.weight"));
  EXPECT_FALSE(weights.contains("output.weight"));
  EXPECT_FALSE(weights.contains("stem.bias"));
}

}  // namespace
}  // namespace e2lf::learn
