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

}  // namespace
}  // namespace e2lf::pipeline
