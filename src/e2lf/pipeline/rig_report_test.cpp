// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/rig_report.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
namespace {

/// Event images of the demo scene with physical pixels.
class RigReports : public testing::Test {
 protected:
  [[nodiscard]] static RigReport report_of(const capture::EventImages& events, MethodChoice choice) {
    capture::MeasurementFile file;
    file.cycles.emplace_back(events);
    CycleInput input = CycleInput::open(EventSource(std::move(file)), {}).value();
    return examine_rig(input, std::move(choice)).value();
  }

  model::Model network_ = read_network(bundled_file_named(kBundledModels, "e2lf-n4-camera").value()).value();
  lightfield::LightField truth_ = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 160, 200});
  capture::EventImages right_ =
      sensor::simulate_pixel_events(*network_.codes, truth_, *network_.camera, {.seed = 7}).value();
};

TEST_F(RigReports, TrustEventsOfTheStatedPatterns) {
  const RigReport report = report_of(right_, {.model = network_, .codes = network_.codes});
  EXPECT_FALSE(diagnose::has_doubt(report.findings)) << diagnose::to_json(report.findings).dump();
  EXPECT_EQ(report.cycles, 1U);
  EXPECT_EQ(report.hot, 0U);
  EXPECT_EQ(report.silent, 0U);
  EXPECT_EQ(report.fits.size(), 1U);
  EXPECT_EQ(report.changes.size(), 8U);  // 2 rotations, 2 exchanges, 3 orientations, inversion
}

TEST_F(RigReports, FindInvertedPolarityAndOtherOrders) {
  capture::EventImages rotated = right_, inverted = right_;
  for (size_t k = 0; k < 3; ++k) std::ranges::copy(right_.image((k + 1) % 3), rotated.image(k).begin());
  for (int16_t& count : inverted.values) count = static_cast<int16_t>(-count);
  const MethodChoice choice{.model = network_, .codes = network_.codes};
  EXPECT_TRUE(contains(report_of(rotated, choice).findings, "order-better-changed"));
  EXPECT_TRUE(contains(report_of(inverted, choice).findings, "polarity-inverted"));
}

TEST_F(RigReports, TryTheBundledPatternsIfNoneAreStated) {
  const RigReport report = report_of(right_, {});
  ASSERT_FALSE(report.fits.empty());
  EXPECT_TRUE(report.fits.front().method.codes->codes == *network_.codes) << report.fits.front().patterns;
  EXPECT_FALSE(report.is_confirmed);
}

/// The transmissions of the network's camera vary over the image, of which the search sees the middle half: it has to
/// compare both cameras with what they are there.
TEST(RigSearches, CompareTheNetworksCameraInTheirWindow) {
  model::Model network = read_network(bundled_file_named(kBundledModels, "e2lf-n4-camera").value()).value();
  network.camera->transmission_slope_x = {0.8F, 0.8F, 0.8F};
  const auto wide = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 64, 1024});
  const capture::EventImages events =
      sensor::simulate_pixel_events(*network.codes, wide, *network.camera, {.seed = 7}).value();
  capture::SensorProfile insensitive = *network.camera;
  for (const auto threshold : {capture::PixelConstant::kThresholdOn, capture::PixelConstant::kThresholdOff}) {
    insensitive.pixel[threshold] *= 3;
  }

  const auto explained_by = [&](const OpenedMethod& method) {
    const FieldCheck check = FieldCheck::create(method).value().value();
    return std::pair(check, check.judge_events(events).value().value());
  };
  const auto [_, of_network] = explained_by(open_method({.model = network}).value());
  const OpenedMethod given = open_method({.model = network, .camera = insensitive}).value();
  const auto [check, of_given] = explained_by(given);

  const RigSearch found = search_rig(given, check, of_given, events, events).value();
  ASSERT_EQ(found.findings.size(), 1U);
  EXPECT_EQ(found.findings[0].code, "camera-worse");
  EXPECT_NEAR(found.findings[0].figures["error"].get<double>(), of_given.error, 1e-9);
  EXPECT_NEAR(found.findings[0].figures["error_with_the_models_camera"].get<double>(), of_network.error, 1e-6);
}

}  // namespace
}  // namespace e2lf::pipeline
