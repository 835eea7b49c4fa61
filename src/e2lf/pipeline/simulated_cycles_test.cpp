// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/simulated_cycles.h"

#include <gtest/gtest.h>

#include "e2lf/lightfield/scene.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::pipeline {
namespace {

TEST(SimulatedCycles, EachCycleHasNoiseOfItsOwnAndCanBeMadeAgain) {
  const auto scene = lightfield::render_light_field(lightfield::demo_scene(1), {8, 8, 24, 32, 1});
  const SimulatedCamera camera{.codes = capture::default_codes(), .profile = {}, .seed = 5};
  const auto second = simulate_cycle(camera, scene, 1).value();
  sensor::EventModelOptions options{.constants = camera.profile.constants, .seed = 6};
  EXPECT_EQ(second.events.values, sensor::simulate_events(camera.codes, scene, options).value().values);
  EXPECT_NE(second.events.values, simulate_cycle(camera, scene, 0)->events.values);
  EXPECT_EQ(second.events.values, simulate_cycle(camera, scene, 1)->events.values);
}

TEST(SimulatedCycles, AHybridHasEventsAndOneImage) {
  const auto scene = lightfield::render_light_field(lightfield::demo_scene(1), {8, 8, 24, 32, 1});
  const SimulatedCamera camera{
      .measurement = capture::MeasurementKind::kHybrid, .codes = capture::default_codes(), .profile = {}};
  const auto measured = simulate_cycle(camera, scene, 0).value();
  EXPECT_EQ(measured.events.count, 3U);
  EXPECT_EQ(measured.images.count, 1U);
}

}  // namespace
}  // namespace e2lf::pipeline
