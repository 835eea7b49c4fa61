// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
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

TEST_F(PrecisionCheck, RefusesModelsWithoutPatterns) {
  model::Model model = random_model();
  model.codes.reset();
  EXPECT_EQ(measure_precision_loss(model, {}).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::pipeline
