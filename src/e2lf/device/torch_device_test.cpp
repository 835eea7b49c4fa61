// SPDX-License-Identifier: MIT
#include "e2lf/device/torch_device.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>

#include "e2lf/files/bundled_files.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/model/model.h"

namespace e2lf::device {
namespace {

using engine::Engine;
using engine::Precision;

/// Makes the devices known once in this process.
class TorchDevice : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    geometry::add_operations();
    add_torch_devices();
  }
};

/// The device to test, for a machine with a GPU; torch on the CPU otherwise.
std::string tested_device() {
  const char* const named = std::getenv("E2LF_DEVICE");
  return named != nullptr ? named : "torch-cpu";
}

model::Model bundled(const std::string& name) {
  return model::read_model(*bundled_file_named(kBundledModels, name)).value();
}

std::vector<float> output_of(const Engine& engine, const model::Network& network, const std::vector<float>& input,
                             size_t height, size_t width) {
  std::vector<float> output(model::infer_shapes(network).value().back().channels * height * width);
  const auto ran = engine.run(input, height, width, output);
  EXPECT_TRUE(ran) << ran.error().text();
  EXPECT_EQ(input.size(), network.input_channels * height * width);
  return output;
}

TEST_F(TorchDevice, ComputesEveryBundledNetworkAsTheEngineDoes) {
  for (const std::string& name : bundled_names(kBundledModels)) {
    model::Model model = bundled(name);
    if (!model.codes && model.open_guide) model = geometry::for_patterns(model, *bundled("e2lf-n4").codes).value();
    const auto engine = Engine::create(model.network, model.weights, {.device = tested_device()});
    ASSERT_TRUE(engine) << name << ": " << engine.error().text();
    const size_t multiple = model::size_multiple(model.network), side = std::max<size_t>(2 * multiple, 64);
    std::mt19937 random(3);
    // Most inputs, such as intensities and the properties of the sensor, are between 0 and about 1. White noise of both
    // signs cancels in the output, which magnifies the rounding.
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<float> input(model.network.input_channels * side * side);
    for (float& value : input) value = uniform(random);
    const auto expected =
        output_of(Engine::create(model.network, model.weights, {.precision = Precision::kFloat32}).value(),
                  model.network, input, side, side);
    EXPECT_EQ(engine->precision(), Precision::kFloat32);
    const auto actual = output_of(*engine, model.network, input, side, side);
    float largest = 0, difference = 0;
    for (size_t i = 0; i < actual.size(); ++i) {
      largest = std::max(largest, std::abs(expected[i]));
      difference = std::max(difference, std::abs(actual[i] - expected[i]));
    }
    // Evidence is a quotient of small sums, and views follow a geometry by a steep function of their detail.
    const bool has_geometry = std::ranges::any_of(
        model.network.layers, [](const model::Layer& layer) { return layer.op == geometry::GeometryOp::kPlaneSweep; });
    EXPECT_LT(difference, (has_geometry ? 1e-3F : 1e-5F) * largest) << name;
    RecordProperty(name, std::to_string(difference / largest));
  }
}

TEST_F(TorchDevice, SaysWhatIsMissingBeforeAnythingIsComputed) {
  const model::Model model = bundled("e2lf-n4");
  const auto code = [&](const engine::EngineOptions& options) {
    const auto engine = Engine::create(model.network, model.weights, options);
    return engine ? ErrorCode::kInternal : engine.error().code;
  };
  EXPECT_EQ(code({.device = "cuda:99"}), ErrorCode::kMissingDependency);
  EXPECT_EQ(engine::check_device("cuda:99").error().code, ErrorCode::kMissingDependency);
  EXPECT_EQ(engine::check_device("cuda:x").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(engine::check_device("tpu").error().code, ErrorCode::kMissingDependency);
  EXPECT_EQ(code({.precision = Precision::kInt16, .device = "torch-cpu"}), ErrorCode::kUnsupported);
  EXPECT_EQ(code({.precision = Precision::kFloat16}), ErrorCode::kUnsupported) << "on the CPU";
}

}  // namespace
}  // namespace e2lf::device
