// SPDX-License-Identifier: MIT
#include "e2lf/recon/event_judgement.h"

#include <gtest/gtest.h>

#include "e2lf/lightfield/demo_scene.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::recon {
namespace {

capture::SensorProfile physical_pixels() {
  using enum capture::PixelConstant;
  capture::SensorProfile camera;
  camera.event_model = "pixel";
  camera.pixel[kEps] = 0.01F;
  camera.pixel[kReceptorRate] = 30.0F;
  camera.pixel[kAmplifierRate] = 300.0F;
  camera.pixel[kThresholdOn] = camera.pixel[kThresholdOff] = 0.3F;
  camera.pixel[kBlackTime] = 0.0156F;
  camera.pixel[kLitTime] = 0.0104F;
  camera.pixel[kResetSpan] = 1.0F;
  camera.pixel[kMismatch] = 0.1F;
  camera.pixel[kNoise] = 0.05F;
  return camera;
}

class Judgements : public testing::Test {
 protected:
  lightfield::LightField truth_ = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 48, 600});
  EventCheck check_{capture::default_codes(), {}, sensor::EventModel::kReferenceAware, physical_pixels()};
  capture::EventImages events_ =
      sensor::simulate_pixel_events(check_.codes, truth_, *check_.pixels, {.seed = 7}).value();
};

TEST_F(Judgements, CallTheLightFieldItselfGoodInBrightAndDarkScenes) {
  for (const float brightness : {1.0F, 0.1F}) {
    lightfield::LightField scene = truth_;
    for (float& value : scene.data()) value *= brightness;
    const auto events = sensor::simulate_pixel_events(check_.codes, scene, *check_.pixels, {.seed = 7}).value();
    const EventJudgement judgement = judge(check_, scene, events, {}).value();
    EXPECT_NEAR(judgement.ratio, 1.0, 0.05) << brightness;
    EXPECT_EQ(judgement.verdict, Verdict::kGood);
  }
}

TEST_F(Judgements, CallInvertedPolarityWrong) {
  for (int16_t& count : events_.values) count = static_cast<int16_t>(-count);
  EXPECT_EQ(judge(check_, truth_, events_, {}).value().verdict, Verdict::kWrong);
}

TEST_F(Judgements, PreferARivalThatExplainsTheEventsMuchBetterAlone) {
  // The light field has the width of the window that judge() cuts out.
  const auto window = [](const capture::Measurement& measured, const ProgressFn&) -> Result<lightfield::LightField> {
    EXPECT_EQ(measured.events.width, 512U);
    lightfield::LightField whole = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 48, 600});
    lightfield::LightField part({8, 8, 48, 512});
    for (size_t v = 0; v < 64; ++v) {
      for (size_t y = 0; y < 48; ++y) {
        for (size_t x = 0; x < 512; ++x) part.at(v / 8, v % 8, y, x) = whole.at(v / 8, v % 8, y, x + 44);
      }
    }
    return part;
  };
  const Rival rival{window, check_};
  EXPECT_EQ(judge(check_, truth_, events_, rival).value().verdict, Verdict::kGood);
  EventCheck named = check_;
  named.pixels->pixel[capture::PixelConstant::kThresholdOn] = 0.6F;
  EXPECT_EQ(judge(named, truth_, events_, rival).value().verdict, Verdict::kRivalBetter);
}

}  // namespace
}  // namespace e2lf::recon
