// SPDX-License-Identifier: MIT
#include "e2lf/engine/stream.h"

#include <cmath>
#include <gtest/gtest.h>
#include <new>

#include "e2lf/model/network.h"
#include "testing/test_networks.h"

namespace e2lf::engine {
namespace {

struct PanelRun {
  std::vector<float> output;
  size_t live_bytes = 0;
};

/// Runs a plan over an image cut into panels of `columns`.
PanelRun run_panels(const Plan& plan, const std::vector<float>& input, size_t height, size_t width, size_t columns) {
  PanelRun result;
  result.output.assign(plan.tensors.back().channels * height * width, NAN);
  for (size_t begin = 0; begin < width; begin += columns) {
    FrameState memory;
    Stream stream(plan, {input, result.output, height, width}, begin, std::min(width, begin + columns), memory);
    while (stream.advance()) {
    }
    result.live_bytes = std::max(result.live_bytes, memory.rows.bytes());
  }
  return result;
}

/// Down and up again, twice: what one pixel at a cut spoils grows to a whole coarse one each time.
TestNetwork down_and_up_twice() {
  return {"down and up twice",
          {1,
           {conv("a", "input", 2, 3), conv("down1", "a", 8, 8, true, "", 8), conv("b", "down1", 8, 3),
            conv("c", "b", 8, 3), transposed("up1", "c", 2, 8), conv("d", "up1", 2, 3),
            conv("down2", "d", 8, 8, true, "", 8), conv("e", "down2", 8, 3), transposed("up2", "e", 2, 8)}},
          8};
}

/// Two layers, and a branch of two that leads nowhere.
TestNetwork with_unread_layers() {
  return {"unread",
          {5, {conv("a", "input", 16, 3), conv("b", "input", 16, 3), conv("c", "b", 8, 3), conv("out", "a", 16, 3)}},
          1};
}

TEST(StreamTest, PanelsGiveWhatTheWholeImageGives) {
  std::vector<TestNetwork> tests = test_networks();
  tests.push_back(down_and_up_twice());
  for (const TestNetwork& test : tests) {
    const Plan plan = make_plan(test.network, random_weights(test.network, 3), ElementType::kFloat32).value();
    const size_t height = 12 * test.multiple;
    const size_t width = 60 * test.multiple;
    const std::vector<float> input = random_values(test.network.input_channels * height * width, 5);
    const auto whole = run_panels(plan, input, height, width, width);
    const auto panels = run_panels(plan, input, height, width, plan.alignment * 3);
    double largest = 0.0;
    for (size_t i = 0; i < whole.output.size(); ++i) {
      const double difference = std::abs(static_cast<double>(panels.output[i]) - whole.output[i]);
      largest = difference <= largest ? largest : difference;  // NaN wins
    }
    // Not bit by bit: a Winograd tile rounds differently when what lies beside it differs.
    EXPECT_LT(largest, 1e-4) << test.name;
  }
}

TEST(StreamTest, HalosHoldAllThatNetworksOfSeveralScalesSee) {
  const model::Network network = model::unet({.input_channels = 9, .head_blocks = 4});
  const Plan plan = make_plan(network, random_weights(network, 3), ElementType::kFloat32).value();
  EXPECT_GE(plan.halo, model::receptive_radius(network));
}

TEST(StreamTest, MemoryDoesNotGrowWithTheHeight) {
  std::vector<TestNetwork> tests = test_networks();
  tests.push_back(with_unread_layers());
  for (const TestNetwork& test : tests) {
    const Plan plan = make_plan(test.network, random_weights(test.network, 3), ElementType::kFloat32).value();
    const auto live_bytes = [&](size_t height) {
      const size_t width = 12 * test.multiple;
      const std::vector<float> input(test.network.input_channels * height * width);
      return run_panels(plan, input, height, width, width).live_bytes;
    };
    // A slab of the pool holds 504 of the smallest rows: with fewer than that nothing would be seen.
    EXPECT_EQ(live_bytes(1200), live_bytes(2400)) << test.name;
  }
}

TEST(StreamTest, LayersThatNobodyReadsAreNotComputed) {
  const TestNetwork test = with_unread_layers();
  const Plan plan = make_plan(test.network, random_weights(test.network, 3), ElementType::kFloat32).value();
  ASSERT_EQ(plan.stages.size(), 2U);
  EXPECT_EQ(plan.stages[0].name, "a");
  EXPECT_EQ(plan.stages[1].name, "out");
}

/// Fails as a kernel does that finds no memory.
class FailingKernel final : public Kernel {
 public:
  [[nodiscard]] std::string describe() const override { return ""; }
  [[nodiscard]] Reach reach() const override { return {1, 1}; }
  void run_block(const Strip& /*strip*/, size_t /*block*/, std::byte* /*scratch*/) const override {
    throw std::bad_alloc();
  }
};

TEST(StreamTest, ExceptionsOfKernelsReachTheCaller) {
  const TestNetwork test = test_networks()[0];
  Plan plan = make_plan(test.network, random_weights(test.network, 3), ElementType::kFloat32).value();
  plan.stages[1].kernel = std::make_unique<FailingKernel>();
  const std::vector<float> input(test.network.input_channels * size_t{40} * 40);
  EXPECT_THROW((void)run_panels(plan, input, 40, 40, 40), std::bad_alloc);
}

/// Adds twelve layers at full resolution, after the last layer.
void add_fine_layers(model::Network& network) {
  for (int i = 0; i < 12; ++i) {
    network.layers.push_back(conv("f" + std::to_string(i), network.layers.back().name, 8, 3));
  }
}

/// A coarse branch, then many layers at full resolution, and a shortcut around all of them.
model::Network deep_network() {
  using model::Op;
  model::Network network{4,
                         {reshape("coarse", Op::kPixelUnshuffle, {"input"}, 4), conv("c1", "coarse", 64, 3),
                          conv("c2", "c1", 128, 3), reshape("fine", Op::kPixelShuffle, {"c2"}, 4)}};
  add_fine_layers(network);
  network.layers.push_back(conv("shortcut", "input", 8, 1));
  network.layers.push_back(reshape("sum", Op::kAdd, {"f11", "shortcut"}));
  return network;
}

/// Layers at 1/64 of the resolution, of which a few rows complete hundreds of the rows of later layers.
model::Network coarse_network() {
  model::Network network{4, {}};
  for (const int i : {0, 1, 2, 3, 4, 5}) {
    const std::string before = i == 0 ? "input" : network.layers.back().name;
    network.layers.push_back(conv("half" + std::to_string(i), before, 8, 2, false, "", 2));
  }
  for (const int i : {0, 1, 2, 3, 4, 5}) {
    network.layers.push_back(transposed("twice" + std::to_string(i), network.layers.back().name, 8, 2));
  }
  add_fine_layers(network);
  return network;
}

/// Many channels, of which one layer keeps a few for the end, and others read them at 1/64 of the resolution.
model::Network keeping_network() {
  model::Network network{4, {conv("wide", "input", 128, 1, false), conv("kept", "wide", 8, 2, false, "", 2)}};
  std::string last = "wide";
  for (const int i : {0, 1, 2, 3, 4, 5}) {
    network.layers.push_back(conv("half" + std::to_string(i), last, 8, 2, false, "", 2));
    last = network.layers.back().name;
  }
  for (const int i : {0, 1, 2, 3, 4}) {
    network.layers.push_back(transposed("twice" + std::to_string(i), last, 8, 2));
    last = network.layers.back().name;
  }
  network.layers.push_back(conv("sum", last, 8, 3, false, "kept"));
  network.layers.push_back(reshape("output", model::Op::kPixelShuffle, {"sum"}, 2));
  return network;
}

size_t most_live_rows(const model::Network& network) {
  const Plan plan = make_plan(network, random_weights(network, 3), ElementType::kFloat32).value();
  const size_t height = 512, width = 512;
  const std::vector<float> input = random_values(4 * height * width, 5);
  const size_t row_bytes = (width + 16) * kChannelMultiple * sizeof(float);
  return run_panels(plan, input, height, width, width).live_bytes / row_bytes;
}

TEST(StreamTest, FewRowsOfDeepNetworksAreLive) {
  // 682 rows of sixteen channels; 868 where every layer computes all that its inputs allow.
  EXPECT_LT(most_live_rows(deep_network()), 700U);
}

TEST(StreamTest, CoarseLayersDoNotFloodThoseAfterThem) {
  // 1055 rows of sixteen channels; 1303 where all rows that the coarse ones complete pass through at once.
  EXPECT_LT(most_live_rows(coarse_network()), 1150U);
}

TEST(StreamTest, LayersThatFreeMemoryDoNotWait) {
  // 1303 rows of sixteen channels; 3165 where the few channels are not computed before the end is.
  EXPECT_LT(most_live_rows(keeping_network()), 1500U);
}

}  // namespace
}  // namespace e2lf::engine
