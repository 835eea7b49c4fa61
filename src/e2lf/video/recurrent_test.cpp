// SPDX-License-Identifier: MIT
// Networks that remember the frame before: the reference against closed forms, the engine against the reference.
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
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

class RecurrentTest : public ::testing::Test {
 protected:
  void TearDown() override {
    set_max_isa("").value();
    set_num_threads(0);
  }
};

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

/// A network of one 1x1 cell with one channel, whose weights are zero but for those given.
struct OneCell {
  model::Network network;
  model::Weights weights;

  explicit OneCell(const std::string& op) : network{1, {cell("cell", op, "input", 1, 1)}} {
    for (const model::WeightShape& tensor : model::weight_shapes(network)) {
      weights[tensor.name].assign(tensor.shape[0] * (tensor.shape.size() > 1 ? tensor.shape[1] : 1), 0.0F);
    }
  }
};

TEST_F(RecurrentTest, AGruThatDoesNotLookGoesToItsCandidateExponentially) {
  OneCell cell(VideoOp::kConvGru);
  cell.weights["cell.gates.bias"] = {-0.5F, 3.0F};
  cell.weights["cell.candidate.bias"] = {0.8F};
  ReferenceState state;
  const double share = sigmoid(-0.5), goal = std::tanh(static_cast<double>(0.8F));
  for (int frame = 1; frame <= 5; ++frame) {
    const auto output = run_reference(cell.network, cell.weights, std::vector<float>{9.0F}, 1, 1, state).value();
    EXPECT_NEAR(output[0], goal * (1.0 - std::pow(1.0 - share, frame)), 1e-6) << frame;
  }
}

TEST_F(RecurrentTest, AGruResetsWhatItsCandidateSeesOfTheFrameBefore) {
  OneCell cell(VideoOp::kConvGru);
  cell.weights["cell.gates.bias"] = {40.0F, 0.25F};      // takes the candidate alone
  cell.weights["cell.candidate.weight"] = {1.0F, 2.0F};  // of x and of r h'
  ReferenceState state{{"cell", {0.3F}}};
  const auto output = run_reference(cell.network, cell.weights, std::vector<float>{0.1F}, 1, 1, state).value();
  EXPECT_NEAR(output[0], std::tanh(0.1 + 2.0 * sigmoid(0.25) * 0.3), 1e-6);
}

TEST_F(RecurrentTest, AnLstmHasItsGatesInTheOrderInputForgetOutputCandidate) {
  OneCell cell(VideoOp::kConvLstm);
  cell.weights["cell.gates.bias"] = {0.1F, 0.2F, 0.3F, 0.4F};
  cell.weights["cell.gates.weight"] = {0, 0, 0, 0, 0, 0, 0.5F, 0.7F};  // g sees x and h'
  ReferenceState state{{"cell", {0.6F}}, {"cell.memory", {-0.9F}}};
  const auto output = run_reference(cell.network, cell.weights, std::vector<float>{2.0F}, 1, 1, state).value();
  const double memory = sigmoid(0.2) * -0.9 + sigmoid(0.1) * std::tanh(0.4 + 0.5 * 2.0 + 0.7 * 0.6);
  EXPECT_NEAR(state["cell.memory"][0], memory, 1e-6);
  EXPECT_NEAR(output[0], sigmoid(0.3) * std::tanh(memory), 1e-6);
}

TEST_F(RecurrentTest, BilinearUpsamplingOfARampIsTheRampUpToTheEdges) {
  const model::Network network{
      1, {conv("half", "input", 1, 2, false, "", 2), reshape("up", VideoOp::kUpsampleBilinear, {"half"}, 2)}};
  const model::Weights weights{{"half.weight", {0.25F, 0.25F, 0.25F, 0.25F}}, {"half.bias", {0.0F}}};
  constexpr size_t kSize = 8;
  std::vector<float> ramp(kSize * kSize);
  for (size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<float>(i % kSize + 10 * (i / kSize));
  const auto output = run_reference(network, weights, ramp, kSize, kSize).value();
  for (size_t y = 1; y + 1 < kSize; ++y) {
    for (size_t x = 1; x + 1 < kSize; ++x) EXPECT_FLOAT_EQ(output[y * kSize + x], ramp[y * kSize + x]) << y << " " << x;
  }
  EXPECT_FLOAT_EQ(output[0], (0 + 1 + 10 + 11) / 4.0F);
}

TEST_F(RecurrentTest, AStridedConvolutionIsCentredOnItsPixels) {
  const model::Network network{1,
                               {conv("a", "input", 1, 3, false, "", 2), reshape("up", VideoOp::kUpsample, {"a"}, 2)}};
  model::Weights weights{{"a.weight", std::vector<float>(9, 0.0F)}, {"a.bias", {0.0F}}};
  weights["a.weight"][4] = 1.0F;
  const auto input = random_values(6 * 8, 1);
  const auto output = run_reference(network, weights, input, 6, 8).value();
  for (size_t y = 0; y < 6; ++y) {
    for (size_t x = 0; x < 8; ++x) EXPECT_EQ(output[y * 8 + x], input[y / 2 * 2 * 8 + x / 2 * 2]);
  }
}

TEST_F(RecurrentTest, FiltersOfOneTapMoveThePictureEachPixelItsOwnWay) {
  // Two filters of 3x3: the pixel to the right, and twice the one above; pixels outside are zero.
  constexpr size_t kRight = 5, kAbove = 9 + 1;
  model::Layer moved = reshape("moved", VideoOp::kDynamicFilter, {"input", "filters"});
  moved.kernel = 3;
  const model::Network network{2, {conv("filters", "input", 18, 1, false), moved}};
  model::Weights weights{{"filters.weight", std::vector<float>(36, 0.0F)}, {"filters.bias", std::vector<float>(18)}};
  weights["filters.bias"][kRight] = 1.0F;
  weights["filters.weight"][kAbove * 2] = 1.0F;  // as strong as channel 0 of the pixel itself
  const size_t height = 3, width = 4, plane = height * width;
  const auto input = random_values(2 * plane, 1);
  const auto output = run_reference(network, weights, input, height, width).value();
  ASSERT_EQ(output.size(), 4 * plane);
  for (size_t i = 0; i < plane; ++i) {
    for (size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(output[c * plane + i], i % width + 1 < width ? input[c * plane + i + 1] : 0.0F);
      EXPECT_EQ(output[(2 + c) * plane + i], i >= width ? input[i] * input[c * plane + i - width] : 0.0F);
    }
  }
}

TEST_F(RecurrentTest, ASumWithTheLastOutputIsARunningSum) {
  const model::Network network{1, {previous("last", 1), reshape("sum", VideoOp::kAdd, {"input", "last"})}};
  const Engine engine = Engine::create(network, {}, {Precision::kFloat32}).value();
  FrameState state;
  std::vector<float> output(6 * 8), expected(6 * 8);
  for (uint64_t frame = 0; frame < 4; ++frame) {
    const auto input = random_values(output.size(), frame);
    engine.run_frame(input, 6, 8, state, output).value();
    for (size_t i = 0; i < expected.size(); ++i) expected[i] += input[i];
    EXPECT_EQ(output, expected) << frame;
  }
}

/// Frames of random input through both; the largest difference of any frame.
double error_over_frames(const TestNetwork& test, size_t height, size_t width, Precision precision) {
  const model::Weights weights = random_weights(test.network, 7);
  const Engine engine = Engine::create(test.network, weights, {precision}).value();
  const size_t channels = model::infer_shapes(test.network).value().back().channels;
  ReferenceState expected_state;
  FrameState state;
  double largest = 0.0;
  for (uint64_t frame = 0; frame < 4; ++frame) {
    const std::vector<float> input = random_values(test.network.input_channels * height * width, 3 + frame);
    const auto expected = run_reference(test.network, weights, input, height, width, expected_state).value();
    std::vector<float> output(channels * height * width, NAN);
    engine.run_frame(input, height, width, state, output).value();
    const double error = largest_difference(output, expected);
    largest = error <= largest ? largest : error;
  }
  return largest;
}

TEST_F(RecurrentTest, EqualsTheReferenceFrameByFrameForEverySizeAndInstructionSet) {
  for (const TestNetwork& test : recurrent_networks()) {
    for (const auto& [rows, columns] : std::vector<std::pair<size_t, size_t>>{{1, 1}, {5, 7}, {3, 25}}) {
      for (const std::string& isa : available_isas()) {
        set_max_isa(isa).value();
        EXPECT_LT(error_over_frames(test, rows * test.multiple, columns * test.multiple, Precision::kFloat32), 1e-4)
            << test.name << " " << rows << "x" << columns << " " << isa;
      }
      set_max_isa("").value();
    }
  }
}

TEST_F(RecurrentTest, Bfloat16StaysNearTheReference) {
  if (!bfloat16_supported()) GTEST_SKIP() << "this CPU has no AVX512_BF16";
  for (const TestNetwork& test : recurrent_networks()) {
    const double error = error_over_frames(test, 6 * test.multiple, 20 * test.multiple, Precision::kBfloat16);
    EXPECT_LT(error, test.name == "dynamic" ? 0.4 : 0.15) << test.name;  // whose values are several times larger
    EXPECT_GT(error, 1e-5) << test.name;
  }
}

TEST_F(RecurrentTest, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const TestNetwork& test : recurrent_networks()) {
    const model::Weights weights = random_weights(test.network, 7);
    const Engine engine = Engine::create(test.network, weights, {Precision::kFloat32}).value();
    const size_t height = 10 * test.multiple, width = 13 * test.multiple;
    const size_t channels = model::infer_shapes(test.network).value().back().channels;
    std::vector<std::vector<float>> results;
    for (const int threads : {1, 3}) {
      set_num_threads(threads);
      FrameState state;
      std::vector<float> output(channels * height * width);
      for (uint64_t frame = 0; frame < 3; ++frame) {
        const auto input = random_values(test.network.input_channels * height * width, frame);
        engine.run_frame(input, height, width, state, output).value();
      }
      results.push_back(output);
    }
    EXPECT_EQ(results[0], results[1]) << test.name;
  }
}

TEST_F(RecurrentTest, ANewStateBeginsAgainAndANetworkWithoutMemoryForgetsEveryFrame) {
  const TestNetwork test = recurrent_networks()[0];
  const Engine engine = Engine::create(test.network, random_weights(test.network, 7), {Precision::kFloat32}).value();
  const auto input = random_values(5 * 8 * 8, 1);
  std::vector<float> first(64), second(64), again(64), alone(64);
  FrameState state;
  engine.run_frame(input, 8, 8, state, first).value();
  engine.run_frame(input, 8, 8, state, second).value();
  state = FrameState();
  engine.run_frame(input, 8, 8, state, again).value();
  engine.run(input, 8, 8, alone).value();
  EXPECT_NE(first, second);
  EXPECT_EQ(first, again);
  EXPECT_EQ(first, alone);
}

TEST_F(RecurrentTest, MemoryDoesNotGrowFromFrameToFrame) {
  for (const TestNetwork& test : recurrent_networks()) {
    const Plan plan = make_plan(test.network, random_weights(test.network, 3), ElementType::kFloat32).value();
    const size_t height = 12 * test.multiple, width = 9 * test.multiple;
    const auto input = random_values(test.network.input_channels * height * width, 5);
    std::vector<float> output(plan.tensors.back().channels * height * width);
    FrameState memory;
    size_t first_bytes = 0;
    for (int frame = 0; frame < 3; ++frame) {
      Stream stream(plan, {input, output, height, width}, 0, width, memory);
      while (stream.advance()) {
      }
      memory.end_frame();
      if (frame == 0) first_bytes = memory.rows.bytes();
      EXPECT_EQ(memory.rows.bytes(), first_bytes) << test.name;
    }
    EXPECT_GT(first_bytes, 0U);
  }
}

TEST_F(RecurrentTest, AStateOfAnotherSizeBreaksTheContract) {
  const TestNetwork test = recurrent_networks()[0];
  const Engine engine = Engine::create(test.network, random_weights(test.network, 7), {Precision::kFloat32}).value();
  FrameState state;
  std::vector<float> output(64);
  engine.run_frame(random_values(5 * 64, 1), 8, 8, state, output).value();
  EXPECT_THROW((void)engine.run_frame(random_values(5 * 64, 1), 4, 16, state, output), ContractError);
}

}  // namespace
}  // namespace e2lf::video
