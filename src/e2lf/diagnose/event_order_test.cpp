// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/event_order.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/diagnose/event_images.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/model/model.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::diagnose {
namespace {

using capture::EventImages;
using capture::RecordedSetup;

RecordedSetup setup_with(const std::string& camera) {
  return {.codes = model::read_model(bundled_file_named(kBundledModels, "e2lf-n4").value()).value().codes,
          .camera = capture::read_camera(bundled_file_named(kBundledCameras, camera).value()).value()};
}

/// Event images of the demo scene.
EventImages events_of(const RecordedSetup& setup, uint64_t seed, float gain = 1.0F) {
  static const lightfield::LightField scene =
      lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 120, 160});
  if (setup.camera->is_pixel()) {
    return sensor::simulate_pixel_events(*setup.codes, scene, *setup.camera, {.gain = gain, .seed = seed}).value();
  }
  return sensor::simulate_events(*setup.codes, scene, {.gain = gain, .seed = seed}).value();
}

std::string code_of(const std::optional<Finding>& finding) {
  return finding ? finding->code : "";
}

class CheckOrder : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Cameras, CheckOrder, testing::Values("evk4-lcos", "ideal", "paper"));

TEST_P(CheckOrder, NamesEachChangeByTheOneThatUndoesIt) {
  const RecordedSetup setup = setup_with(GetParam());
  const EventImages right = events_of(setup, 3);
  const std::vector<EventChange> changes = event_changes(3);
  for (const EventChange& made : changes) {
    const EventImages wrong = made.apply(right);
    const auto finding = check_order(wrong, 1, setup);
    ASSERT_TRUE(finding) << made.name;
    EXPECT_EQ(finding->code, made.code);
    const auto undoing = std::ranges::find(changes, finding->figures["change"].get<std::string>(), &EventChange::name);
    ASSERT_NE(undoing, changes.end());
    EXPECT_EQ(undoing->apply(wrong).values, right.values) << made.name;
  }
}

TEST_P(CheckOrder, SaysNothingOfRightEvents) {
  const RecordedSetup setup = setup_with(GetParam());
  for (const float gain : {1.0F, 0.3F, 0.1F, 0.03F, 0.0F}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      EXPECT_EQ(code_of(check_order(events_of(setup, seed, gain), 1, setup)), "") << gain << " " << seed;
    }
  }
}

TEST_P(CheckOrder, TakesSumsOfCycles) {
  const RecordedSetup setup = setup_with(GetParam());
  EventImages sum = events_of(setup, 1);
  for (uint64_t seed = 2; seed <= 5; ++seed) {
    const EventImages more = events_of(setup, seed);
    for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] = capture::saturated(sum.values[i] + more.values[i]);
  }
  EXPECT_EQ(code_of(check_order(sum, 5, setup)), "");
  EXPECT_EQ(code_of(check_order(event_changes(3)[0].apply(sum), 5, setup)), "polarity-inverted");
}

// A camera or patterns that were wrongly stated are no reason to doubt the signs.
TEST_P(CheckOrder, SaysNothingOfAnotherCamera) {
  for (const char* other : {"evk4-lcos", "ideal", "paper"}) {
    for (const float gain : {1.0F, 0.3F, 0.1F, 0.03F}) {
      if (GetParam() == std::string("paper") && gain < 0.1F) continue;  // leaks in the dark cause OFF events alone
      EXPECT_EQ(code_of(check_order(events_of(setup_with(other), 2, gain), 1, setup_with(GetParam()))), "")
          << other << " " << gain;
    }
  }
}

TEST(CheckOrderAlone, NeedsPatternsAndCamera) {
  const RecordedSetup setup = setup_with("evk4-lcos");
  const EventImages wrong = event_changes(3)[0].apply(events_of(setup, 1));
  EXPECT_TRUE(check_order(wrong, 1, setup));
  EXPECT_FALSE(check_order(wrong, 1, {.codes = setup.codes}));
  EXPECT_FALSE(check_order(wrong, 1, {.camera = setup.camera}));
  EXPECT_FALSE(check_order(middle_of(wrong, 16, 16), 1, setup)) << "too small";
  RecordedSetup lit = setup;
  std::ranges::fill(lit.codes->pattern(0), 1.0F);
  EXPECT_FALSE(check_order(wrong, 1, lit)) << "physical pixels begin with black";
}

}  // namespace
}  // namespace e2lf::diagnose
