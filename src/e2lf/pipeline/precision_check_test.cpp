// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/pipeline/simulated_cycles.h"
#include "e2lf/recon/reconstruct.h"
#include "testing/test_networks.h"

namespace e2lf::pipeline {
namespace {

using engine::Precision;

class PrecisionCheck : public testing::Test {
 protected:
  void TearDown() override { set_max_isa("").value(); }
};

model::Model random_model() {
  model::Model model;
  model.name = "random";
  model.num_patterns = 4;
  model.codes = capture::Codes(4, 8, 8);
  for (size_t i = 64; i < 4 * 64; ++i) model.codes->values[i] = i * 7 % 3 == 0 ? 1.0F : 0.0F;
  model.input = {{model::InputKind::kCounts, 0.125F}};
  model.network = model::recnet(3, 64, 16);
  model.weights = engine::random_weights(model.network, 3);
  return model;
}

Precision automatic(const model::Model& model) {
  return recon::Reconstructor::create(model).value().engine().precision();
}

TEST_F(PrecisionCheck, AutomaticPrecisionIsFloat32UntilItWasChecked) {
  model::Model model = random_model();
  EXPECT_EQ(automatic(model), Precision::kFloat32);
  const std::vector<lightfield::LightField> scenes = {
      lightfield::render_light_field(lightfield::demo_scene(1), {8, 8, 24, 32, 1})};
  model.precision_loss = measure_precision_loss(model, scenes).value();
  const bool has_bfloat16 = recon::Reconstructor::create(model, {Precision::kBfloat16}).ok();
  EXPECT_EQ(model.precision_loss.bfloat16_db.has_value(), has_bfloat16);
  EXPECT_EQ(automatic(model), has_bfloat16 ? Precision::kBfloat16 : Precision::kFloat32);
  set_max_isa("sse4").value();
  EXPECT_EQ(automatic(model), Precision::kFloat32);
  EXPECT_EQ(measure_precision_loss(model, scenes).value(), model::PrecisionLoss());
}

TEST_F(PrecisionCheck, JudgesNetworksForDepthByTheirDisparities) {
  model::Model model = random_model();
  model.network = model::recnet(3, model::kDepthOutputs, 16);
  model.weights = engine::random_weights(model.network, 3);
  const std::vector<lightfield::LightField> scenes = {
      lightfield::render_light_field(lightfield::demo_scene(1), {8, 8, 48, 64, 1})};
  const lightfield::Image truth = depth::true_disparity(scenes[0], std::nullopt).value().disparity;
  const capture::Measurement events = simulate_cycle({.codes = *model.codes}, scenes[0], 0).value();
  const auto error = [&](Precision precision) {
    const auto outputs = recon::Reconstructor::create(model, {precision}).value().reconstruct(events).value();
    double sum = 0;
    for (size_t i = 0; i < truth.pixels.size(); ++i) sum += std::pow(outputs.data()[i] - truth.pixels[i], 2);
    return sum;
  };
  const model::PrecisionLoss loss = measure_precision_loss(model, scenes).value();
  if (!loss.bfloat16_db) GTEST_SKIP() << "this processor has no bfloat16";
  EXPECT_NEAR(*loss.bfloat16_db, 10 * std::log10(error(Precision::kBfloat16) / error(Precision::kFloat32)), 1e-3);
}

TEST_F(PrecisionCheck, RefusesModelsWithoutPatterns) {
  model::Model model = random_model();
  model.codes.reset();
  EXPECT_EQ(measure_precision_loss(model, {}).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::pipeline
