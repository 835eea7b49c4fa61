// SPDX-License-Identifier: MIT
#include "e2lf/engine/engine.h"

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>
#include <utility>

#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/safetensors.h"
#include "testing/engine_reference.h"
#include "testing/engine_runs.h"
#include "testing/test_networks.h"

namespace e2lf::engine {
namespace {

using ::testing::HasSubstr;

/// Lifts caps on instruction sets and threads when a test ends.
class EngineTest : public ::testing::Test {
 protected:
  void TearDown() override {
    set_max_isa("").value();
    set_num_threads(0);
  }
};

const std::vector<std::pair<size_t, size_t>> kSizes = {{1, 1}, {5, 7}, {4, 4}, {8, 9}, {37, 53}, {3, 129}, {26, 16}};

TEST_F(EngineTest, EqualsTheReferenceForEveryNetworkSizeAndInstructionSet) {
  for (const TestNetwork& test : test_networks()) {
    const model::Weights weights = random_weights(test.network, 7);
    for (const auto& [rows, columns] : kSizes) {
      const size_t height = rows * test.multiple;
      const size_t width = columns * test.multiple;
      const std::vector<float> input = random_values(test.network.input_channels * height * width, 3);
      const std::vector<float> expected = run_reference(test.network, weights, input, height, width).value();
      for (const std::string& isa : available_isas()) {
        set_max_isa(isa).value();
        const std::vector<float> output = run_engine(test.network, weights, input, height, width);
        EXPECT_LT(largest_difference(output, expected), 1e-4)
            << test.name << " " << height << "x" << width << " " << isa;
        set_max_isa("").value();
      }
    }
  }
}

TEST_F(EngineTest, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const TestNetwork& test : test_networks()) {
    const model::Weights weights = random_weights(test.network, 1);
    const size_t height = 36;
    const size_t width = 132;
    const std::vector<float> input = random_values(test.network.input_channels * height * width, 2);
    for (const Precision precision : {Precision::kFloat32, Precision::kAuto}) {
      set_num_threads(1);
      const std::vector<float> alone = run_engine(test.network, weights, input, height, width, precision);
      for (const int threads : {2, 3, 7}) {
        set_num_threads(threads);
        EXPECT_EQ(run_engine(test.network, weights, input, height, width, precision), alone)
            << test.name << " " << word_of(precision, kPrecisions) << " " << threads;
      }
    }
  }
}

TEST_F(EngineTest, ThreadsThatRunOneEngineAtOnceGetTheSameBits) {
  constexpr size_t kThreads = 4, kRuns = 3, kHeight = 36, kWidth = 132;
  for (const TestNetwork& test : test_networks()) {
    const Engine engine = Engine::create(test.network, random_weights(test.network, 1)).value();
    std::vector<std::vector<float>> inputs, expected;
    for (size_t i = 0; i < kThreads; ++i) {
      inputs.push_back(random_values(test.network.input_channels * kHeight * kWidth, 2 + i));
      expected.emplace_back(model::infer_shapes(test.network).value().back().channels * kHeight * kWidth);
      ASSERT_TRUE(engine.run(inputs[i], kHeight, kWidth, expected[i]));
    }
    std::vector<size_t> same(kThreads);
    std::vector<std::thread> threads;
    for (size_t i = 0; i < kThreads; ++i) {
      threads.emplace_back([&, i] {
        for (size_t run = 0; run < kRuns; ++run) {
          std::vector<float> output(expected[i].size());
          engine.run(inputs[i], kHeight, kWidth, output).value();
          same[i] += output == expected[i];
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_THAT(same, ::testing::Each(kRuns)) << test.name;
  }
}

TEST_F(EngineTest, EndsAtOnceIfAStopIsRequested) {
  const TestNetwork test = test_networks()[3];
  const Engine engine = Engine::create(test.network, random_weights(test.network, 5)).value();
  const size_t height = 16 * test.multiple, width = 16 * test.multiple;
  const std::vector<float> input = random_values(test.network.input_channels * height * width, 2);
  std::vector<float> output(run_engine(test.network, random_weights(test.network, 5), input, height, width).size());
  size_t reports = 0;
  const auto stopped = engine.run(input, height, width, output, [&](uint64_t, uint64_t) {
    ++reports;
    request_stop(SIGINT);
  });
  request_stop(0);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(reports, 1U);
  EXPECT_TRUE(engine.run(input, height, width, output));
}

TEST_F(EngineTest, CutsWideImagesWithoutTraces) {
  const TestNetwork test = test_networks()[3];
  const model::Weights weights = random_weights(test.network, 5);
  const size_t height = 8;
  const size_t width = 4104;  // three panels
  const std::vector<float> input = random_values(test.network.input_channels * height * width, 2);
  const std::vector<float> expected = run_reference(test.network, weights, input, height, width).value();
  EXPECT_LT(largest_difference(run_engine(test.network, weights, input, height, width), expected), 1e-4);
}

TEST_F(EngineTest, Bfloat16StaysCloseToFloat32) {
  if (!bfloat16_supported()) GTEST_SKIP() << "this CPU has no AVX512_BF16";
  for (const TestNetwork& test : test_networks()) {
    const model::Weights weights = random_weights(test.network, 9);
    const size_t height = 24;
    const size_t width = 60;
    const std::vector<float> input = random_values(test.network.input_channels * height * width, 4);
    const auto exact = run_engine(test.network, weights, input, height, width);
    for (const std::string isa : {"avx512", "amx"}) {
      set_max_isa(isa).value();
      auto narrow = run_engine(test.network, weights, input, height, width, Precision::kBfloat16);
      for (size_t i = 0; i < narrow.size(); ++i) narrow[i] -= exact[i];
      // 8 bits of mantissa, errors of a few layers added up and amplified by the transforms.
      EXPECT_LT(root_mean_square(narrow), 0.05 * root_mean_square(exact)) << test.name << " " << isa;
      EXPECT_GT(root_mean_square(narrow), 0.0) << test.name << " " << isa;
      set_max_isa("").value();
    }
  }
}

TEST_F(EngineTest, Int16StaysCloseToFloat32) {
  if (!int16_supported()) GTEST_SKIP() << "this CPU has no fast int16 products";
  for (const TestNetwork& test : test_networks()) {
    const model::Weights weights = random_weights(test.network, 9);
    const size_t height = 24, width = 60;
    const std::vector<float> input = random_values(test.network.input_channels * height * width, 4);
    const auto exact = run_engine(test.network, weights, input, height, width);
    auto rounded = run_engine(test.network, weights, input, height, width, Precision::kInt16);
    for (size_t i = 0; i < rounded.size(); ++i) rounded[i] -= exact[i];
    EXPECT_LT(root_mean_square(rounded), 0.05 * root_mean_square(exact)) << test.name;
  }
}

TEST_F(EngineTest, RoundsToInt16OnlyIfThatIsAllowed) {
  const TestNetwork test = test_networks()[0];
  const model::Weights weights = random_weights(test.network, 1);
  set_max_isa("sse4").value();
  EXPECT_EQ(Engine::create(test.network, weights, {Precision::kInt16}).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(Engine::create(test.network, weights, {Precision::kAuto, {Precision::kInt16}}).value().precision(),
            Precision::kFloat32);
  set_max_isa("avx2").value();
  if (!int16_supported()) GTEST_SKIP() << "this CPU has no fast int16 products";
  EXPECT_EQ(Engine::create(test.network, weights, {Precision::kAuto}).value().precision(), Precision::kFloat32);
  EXPECT_EQ(Engine::create(test.network, weights, {Precision::kAuto, {Precision::kInt16}}).value().precision(),
            Precision::kInt16);
  EXPECT_EQ(Engine::create(test.network, weights, {Precision::kFloat32, {Precision::kInt16}}).value().precision(),
            Precision::kFloat32);
}

TEST_F(EngineTest, RefusesBfloat16WhereTheInstructionSetIsCapped) {
  set_max_isa("avx2").value();
  const TestNetwork test = test_networks()[0];
  const auto engine = Engine::create(test.network, random_weights(test.network, 1), {Precision::kBfloat16});
  ASSERT_FALSE(engine.ok());
  EXPECT_EQ(engine.error().code, ErrorCode::kUnsupported);
  const auto automatic = Engine::create(test.network, random_weights(test.network, 1));
  ASSERT_TRUE(automatic.ok());
  EXPECT_EQ(automatic->precision(), Precision::kFloat32);
}

TEST_F(EngineTest, NamesTheWeightThatIsMissingOrOfAnotherSize) {
  const TestNetwork test = test_networks()[0];
  model::Weights weights = random_weights(test.network, 1);
  weights.at("b.bias").push_back(0.0F);
  auto engine = Engine::create(test.network, weights);
  ASSERT_FALSE(engine.ok());
  EXPECT_EQ(engine.error().code, ErrorCode::kShape);
  EXPECT_THAT(engine.error().text(), HasSubstr("b.bias"));
  weights.erase("b.bias");
  engine = Engine::create(test.network, weights);
  ASSERT_FALSE(engine.ok());
  EXPECT_EQ(engine.error().code, ErrorCode::kNotFound);
}

TEST_F(EngineTest, RefusesNetworksThatEndAtAnotherResolution) {
  for (const model::Network& network :
       {model::Network{3, {conv("a", "input", 8, 2, true, "", 2)}},
        model::Network{3, {conv("a", "input", 8, 3), reshape("b", model::Op::kPixelUnshuffle, {"a"}, 2)}}}) {
    const auto engine = Engine::create(network, random_weights(network, 1));
    ASSERT_FALSE(engine.ok());
    EXPECT_EQ(engine.error().code, ErrorCode::kShape);
    EXPECT_EQ(engine.error().location, cat("layer \"", network.layers.back().name, "\""));
  }
}

TEST_F(EngineTest, BreaksTheContractForSizesThatDoNotFit) {
  const TestNetwork test = test_networks()[3];
  const Engine engine = Engine::create(test.network, random_weights(test.network, 1)).value();
  std::vector<float> input(3 * 6 * 8);
  std::vector<float> output(6 * 6 * 8);
  EXPECT_THROW((void)engine.run(input, 6, 8, output), ContractError);
}

TEST_F(EngineTest, TheReferenceBreaksTheContractForSizesThatDoNotFit) {
  const TestNetwork test = test_networks()[3];
  const model::Weights weights = random_weights(test.network, 1);
  const std::vector<float> input(3 * 8 * 8);
  EXPECT_THROW((void)run_reference(test.network, weights, input, 8, 9), ContractError);
  EXPECT_THROW((void)run_reference(test.network, weights, std::vector<float>(3 * 6 * 8), 6, 8), ContractError);
  for (const char* name : {"e1.weight", "e1.bias", "t1.weight", "t1.bias"}) {
    model::Weights shorter = weights;
    shorter.at(name).pop_back();
    EXPECT_THROW((void)run_reference(test.network, shorter, input, 8, 8), ContractError) << name;
  }
}

TEST_F(EngineTest, ReportsProgressToTheEnd) {
  const TestNetwork test = test_networks()[0];
  const Engine engine = Engine::create(test.network, random_weights(test.network, 1)).value();
  std::vector<float> output(16 * 40 * 9);
  size_t last = 0;
  size_t all = 0;
  engine
      .run(random_values(5 * 40 * 9, 1), 40, 9, output,
           [&](size_t done, size_t total) {
             EXPECT_GE(done, last);
             last = done;
             all = total;
           })
      .value();
  EXPECT_EQ(last, all);
  EXPECT_GT(all, 0U);
}

TEST_F(EngineTest, ComputesSomeOutputsAloneAsItComputesAll) {
  for (const TestNetwork& test : test_networks()) {
    const model::Weights weights = random_weights(test.network, 5);
    const size_t height = 12 * test.multiple, width = 9 * test.multiple, plane = height * width;
    const std::vector<float> input = random_values(test.network.input_channels * plane, 3);
    for (const std::string& isa : available_isas()) {
      set_max_isa(isa).value();
      const Engine engine = Engine::create(test.network, weights, {Precision::kFloat32}).value();
      const size_t channels = model::infer_shapes(test.network).value().back().channels;
      const std::vector<size_t> wanted = {channels - 1, channels / 2};
      const auto some = engine.with_outputs(wanted);
      const model::Layer& last = test.network.layers.back();
      EXPECT_EQ(some.has_value(), engine.describe().back().starts_with(last.name + ": ") && last.residual.empty() &&
                                      (last.op == model::Op::kConv || last.op == model::Op::kConvTransposed))
          << test.name;
      if (!some) continue;
      std::vector<float> all(channels * plane), output(all.size(), 7.0F);
      engine.run(input, height, width, all).value();
      FrameState room;  // is used again
      for (int run = 0; run < 2; ++run) some->run_frame(input, height, width, room, output).value();
      for (size_t channel = 0; channel < channels; ++channel) {
        const bool is_wanted = std::ranges::find(wanted, channel) != wanted.end();
        for (size_t i = channel * plane; i < (channel + 1) * plane; ++i) {
          ASSERT_EQ(output[i], is_wanted ? all[i] : 7.0F) << test.name << " " << isa << " channel " << channel;
        }
      }
    }
  }
}

TEST_F(EngineTest, DescribesEveryStage) {
  const TestNetwork test = test_networks()[2];
  const auto engine = Engine::create(test.network, random_weights(test.network, 1), {Precision::kFloat32}).value();
  const auto lines = engine.describe();
  ASSERT_EQ(lines.size(), 5U);  // three layers are one
  EXPECT_THAT(lines[0], HasSubstr("f1+f2+f3: 3 layers composed"));
  EXPECT_THAT(lines[1], HasSubstr("l1: Winograd"));
}

TEST_F(EngineTest, ConvolutionsMakeSumsThemselves) {
  const TestNetwork test = test_networks().back();
  const auto engine = Engine::create(test.network, random_weights(test.network, 1)).value();
  const auto lines = engine.describe();
  ASSERT_EQ(lines.size(), 10U);  // of thirteen layers
  for (const char* name : {"up+first: ", "b+second: ", "e+third: "}) {
    EXPECT_THAT(lines, testing::Contains(HasSubstr(name)));
  }
}

TEST_F(EngineTest, ReproducesTheReleasedNetworkOnARealCapture) {
  const char* data = std::getenv("E2LF_DATA");
  const std::filesystem::path folder = std::filesystem::path(data == nullptr ? "" : data) / "official";
  if (!std::filesystem::exists(folder / "RecNet.safetensors")) GTEST_SKIP() << "E2LF_DATA/official is not there";
  const auto file = read_safetensors(folder / "RecNet.safetensors").value();
  model::Weights weights;
  for (const auto& [name, tensor] : file.tensors) weights[name] = tensor.to_float(name).value();
  // The rows around the lower crop with all the context it needs, as an image of its own, and the top ones.
  const auto events = [&](size_t begin, size_t end) {
    std::vector<float> input;
    for (int k = 0; k < 3; ++k) {
      const auto image = read_npy(folder / "Animals" / cat("event_image_0000", k, ".npy")).value();
      const std::vector<float> counts = image.to_float("events").value();
      for (size_t i = begin * 1280; i < end * 1280; ++i) input.push_back(counts[i] / 8.0F);
    }
    return input;
  };
  const auto check = [&](size_t begin, size_t end, size_t y, size_t x) {
    const size_t height = end - begin;
    const std::vector<float> input = events(begin, end);
    const auto crop_of = [&](const std::vector<float>& output) {
      std::vector<float> crop;
      for (size_t view = 0; view < 64; ++view) {
        for (size_t row = 0; row < 64; ++row) {
          const auto from = output.begin() + static_cast<ptrdiff_t>((view * height + y - begin + row) * 1280 + x);
          crop.insert(crop.end(), from, from + 64);
        }
      }
      return crop;
    };
    const auto golden = read_npy(folder / "Animals" / cat("golden_recon_64x64x64_crop_y", y, "_x", x, "_f32.npy"))
                            .value()
                            .to_float("")
                            .value();
    const auto exact = crop_of(run_engine(model::recnet(3), weights, input, height, 1280));
    EXPECT_LT(largest_difference(exact, golden), 1e-4);
    if (!bfloat16_supported()) return;
    auto narrow = crop_of(run_engine(model::recnet(3), weights, input, height, 1280, Precision::kBfloat16));
    for (size_t i = 0; i < narrow.size(); ++i) narrow[i] -= golden[i];
    EXPECT_GT(-20.0 * std::log10(root_mean_square(narrow)), 55.0);
  };
  check(0, 96, 0, 0);
  check(300, 420, 328, 608);
}

}  // namespace
}  // namespace e2lf::engine
