// SPDX-License-Identifier: MIT
// Networks whose pixels see the whole image: the reference against closed forms, the engine against the reference.
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/base/isa.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/engine.h"
#include "e2lf/engine/stream.h"
#include "testing/engine_runs.h"
#include "testing/video_networks.h"
#include "testing/video_reference.h"

namespace e2lf::video {
namespace {

using namespace engine;

class AttentionTest : public ::testing::Test {
 protected:
  void TearDown() override {
    set_max_isa("").value();
    set_num_threads(0);
  }
};

/// Queries, keys and values by convolutions of 1x1 of two input channels.
struct LookNetwork {
  model::Network network{2,
                         {conv("q", "input", 2, 1, false), conv("k", "input", 2, 1, false),
                          conv("v", "input", 2, 1, false), attention("out", {"q", "k", "v"}, 1)}};
  model::Weights weights{{"q.weight", {0, 0, 0, 0}}, {"k.weight", {1, 0, 0, 1}}, {"v.weight", {1, 0, 0, 1}},
                         {"q.bias", {0, 0}},         {"k.bias", {0, 0}},         {"v.bias", {0, 0}}};
};

TEST_F(AttentionTest, PixelsThatAskForNothingGetTheMean) {
  const LookNetwork look;
  const auto input = random_values(2 * 7 * 9, 1);
  const double mean = std::accumulate(input.begin(), input.begin() + 63, 0.0) / 63.0;
  for (const auto& output : {run_reference(look.network, look.weights, input, 7, 9).value(),
                             run_engine(look.network, look.weights, input, 7, 9)}) {
    for (size_t i = 0; i < 63; ++i) EXPECT_NEAR(output[i], mean, 1e-6);
  }
}

TEST_F(AttentionTest, ScoresAreDividedByTheRootOfTheChannels) {
  // Three pixels whose keys are their number, and queries of one.
  LookNetwork look;
  look.weights["q.bias"] = {1, 0};
  const std::vector<float> input = {0, 1, 2, 5, 7, 11};
  const double a = std::exp(1.0 / std::sqrt(2.0)), b = std::exp(2.0 / std::sqrt(2.0));
  const double expected = (5.0 + a * 7.0 + b * 11.0) / (1.0 + a + b);
  EXPECT_NEAR(run_reference(look.network, look.weights, input, 1, 3).value()[4], expected, 1e-6);
  EXPECT_NEAR(run_engine(look.network, look.weights, input, 1, 3)[4], expected, 1e-6);
}

TEST_F(AttentionTest, OfScoresFarApartTheLargestWinsWhereverItStands) {
  LookNetwork look;
  look.weights["q.bias"] = {3e4F, 0};
  for (const size_t best : {size_t{0}, size_t{50}, size_t{199}}) {
    auto input = random_values(2 * 200, 1, 0.5F);
    input[best] = 1.0F;
    const auto output = run_engine(look.network, look.weights, input, 10, 20);
    for (size_t i = 0; i < 200; ++i) EXPECT_EQ(output[200 + i], input[200 + best]) << best;
  }
}

TEST_F(AttentionTest, ALayerNormGivesChannelsMeanZeroAndVarianceOne) {
  const model::Network network{4, {reshape("out", VideoOp::kLayerNorm, {"input"})}};
  const model::Weights weights{{"out.weight", {1, 1, 2, 1}}, {"out.bias", {0, 0, 0, 10}}};
  const std::vector<float> input = {1, 2, 3, 6};  // mean 3, variance 3.5
  const double unit = 1.0 / std::sqrt(3.5 + 1e-5);
  for (const auto& output :
       {run_reference(network, weights, input, 1, 1).value(), run_engine(network, weights, input, 1, 1)}) {
    EXPECT_NEAR(output[0], -2.0 * unit, 1e-6);
    EXPECT_NEAR(output[1], -unit, 1e-6);
    EXPECT_NEAR(output[2], 0.0, 1e-6);
    EXPECT_NEAR(output[3], 10.0 + 3.0 * unit, 1e-6);
  }
}

TEST_F(AttentionTest, APositionCodeCountsPixelsRowByRow) {
  const model::Network network{4, {reshape("out", VideoOp::kPositionCode, {"input"})}};
  const size_t height = 120, width = 100, plane = height * width;
  const std::vector<float> input(4 * plane, 0.5F);
  for (const auto& output :
       {run_reference(network, {}, input, height, width).value(), run_engine(network, {}, input, height, width)}) {
    for (const size_t n : {size_t{0}, size_t{1}, size_t{101}, plane - 1}) {
      const auto at = static_cast<double>(n);
      EXPECT_NEAR(output[n], 0.5 + std::sin(at), 1e-6) << n;
      EXPECT_NEAR(output[plane + n], 0.5 + std::cos(at), 1e-6) << n;
      EXPECT_NEAR(output[2 * plane + n], 0.5 + std::sin(at / 100.0), 1e-6) << n;
      EXPECT_NEAR(output[3 * plane + n], 0.5 + std::cos(at / 100.0), 1e-6) << n;
    }
  }
}

TEST_F(AttentionTest, EqualsTheReferenceForEveryNetworkSizeAndInstructionSet) {
  for (const TestNetwork& test : whole_image_networks()) {
    const model::Weights weights = random_weights(test.network, 7);
    for (const auto& [rows, columns] : std::vector<std::pair<size_t, size_t>>{{1, 1}, {5, 7}, {3, 33}, {26, 16}}) {
      const size_t height = rows * test.multiple, width = columns * test.multiple;
      const auto input = random_values(test.network.input_channels * height * width, 3);
      const auto expected = run_reference(test.network, weights, input, height, width).value();
      for (const std::string& isa : available_isas()) {
        set_max_isa(isa).value();
        EXPECT_LT(largest_difference(run_engine(test.network, weights, input, height, width), expected), 1e-4)
            << test.name << " " << height << "x" << width << " " << isa;
        set_max_isa("").value();
      }
    }
  }
}

TEST_F(AttentionTest, WideImagesAreNotCut) {
  const TestNetwork test = whole_image_networks()[2];
  const model::Weights weights = random_weights(test.network, 5);
  const size_t height = 4, width = 2100;
  const auto input = random_values(test.network.input_channels * height * width, 2);
  const auto expected = run_reference(test.network, weights, input, height, width).value();
  EXPECT_LT(largest_difference(run_engine(test.network, weights, input, height, width), expected), 1e-4);
}

TEST_F(AttentionTest, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const TestNetwork& test : whole_image_networks()) {
    const model::Weights weights = random_weights(test.network, 1);
    const size_t height = 24, width = 40;
    const auto input = random_values(test.network.input_channels * height * width, 2);
    set_num_threads(1);
    const auto alone = run_engine(test.network, weights, input, height, width, Precision::kAuto);
    for (const int threads : {2, 5}) {
      set_num_threads(threads);
      EXPECT_EQ(run_engine(test.network, weights, input, height, width, Precision::kAuto), alone) << test.name;
    }
  }
}

TEST_F(AttentionTest, Bfloat16StaysCloseToFloat32) {
  if (!bfloat16_supported()) GTEST_SKIP() << "this CPU has no AVX512_BF16";
  for (const TestNetwork& test : whole_image_networks()) {
    const model::Weights weights = random_weights(test.network, 9);
    const auto input = random_values(test.network.input_channels * size_t{24} * 60, 4);
    const auto exact = run_engine(test.network, weights, input, 24, 60);
    auto narrow = run_engine(test.network, weights, input, 24, 60, Precision::kBfloat16);
    for (size_t i = 0; i < narrow.size(); ++i) narrow[i] -= exact[i];
    EXPECT_LT(root_mean_square(narrow), 0.05 * root_mean_square(exact)) << test.name;
    EXPECT_GT(root_mean_square(narrow), 0.0) << test.name;
  }
}

size_t live_bytes(const TestNetwork& test, size_t height, size_t width) {
  const Plan plan = make_plan(test.network, random_weights(test.network, 3), ElementType::kFloat32).value();
  const std::vector<float> input(test.network.input_channels * height * width);
  std::vector<float> output(plan.tensors.back().channels * height * width);
  FrameState memory;
  Stream stream(plan, {input, output, height, width}, 0, width, memory);
  while (stream.advance()) {
  }
  return memory.rows.bytes();
}

/// The matrix of all pairs of pixels would be 262 MB.
TEST_F(AttentionTest, MemoryGrowsWithThePixelsAndNotWithTheirPairs) {
  const model::Network wide{256, {attention("out", {"input", "input", "input"}, 8)}};
  const Plan plan = make_plan(wide, {}, ElementType::kFloat32).value();
  EXPECT_LT(plan.stages.back().kernel->scratch_bytes(), 100'000U);
  const TestNetwork test = whole_image_networks()[1];
  const size_t small = live_bytes(test, 32, 64), large = live_bytes(test, 128, 64);
  EXPECT_LT(large, 5 * small);
  EXPECT_LT(large, 8U << 20U);
}

/// All rows of one tensor of 64 channels would be 67 MB, and there are four.
TEST_F(AttentionTest, WhatStandsBeforeAndBehindIsThereInAFewRowsAlone) {
  const TestNetwork test{"deep",
                         {1,
                          {conv("a", "input", 64, 3), conv("b", "a", 64, 3), conv("c", "b", 8, 16, false, "", 16),
                           attention("look", {"c", "c", "c"}, 1), transposed("up", "look", 64, 16),
                           conv("d", "up", 64, 3), conv("out", "d", 1, 1)}},
                         16};
  EXPECT_LT(live_bytes(test, 2048, 128), 40U << 20U);
}

}  // namespace
}  // namespace e2lf::video
