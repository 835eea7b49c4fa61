// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/rig_search.h"

#include <gtest/gtest.h>

#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
namespace {

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
    const FieldCheck check = FieldCheck::create(method, {}).value().value();
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
