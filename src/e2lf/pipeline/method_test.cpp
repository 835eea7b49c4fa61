// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/method.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/files/bundled_files.h"
#include "e2lf/pipeline/catalogue.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::pipeline {
namespace {

using testing::HasSubstr;
using testing::Not;

model::Model bundled(const char* name) {
  return read_network(bundled_file_named(kBundledModels, name).value()).value();
}

capture::SensorProfile pixel_camera() {
  return bundled("e2lf-n4-camera").camera.value();
}

/// Returns black and two openings, of side x side cells.
capture::Codes other_patterns(size_t side) {
  capture::Codes codes(3, side, side);
  codes.pattern(1)[0] = codes.pattern(2)[3] = 1;
  return codes;
}

/// Returns the events of a step of the light on a few pixels.
capture::EventImages some_events() {
  capture::EventImages images(3, 16, 24);
  for (size_t i = 0; i < images.values.size(); i += 3) images.values[i] = static_cast<int16_t>(i % 7) - 2;
  return images;
}

TEST(OpenMethod, TakesTheBundledNetworkForPatternsAndCamera) {
  const capture::Codes codes = *bundled("e2lf-n4").codes;
  const auto of_paper = open_method({.events = {.codes = codes, .camera = capture::SensorProfile()}});
  ASSERT_TRUE(of_paper) << of_paper.error().text();
  EXPECT_EQ(of_paper->network->model().name, "e2lf-n4-geometry");
  EXPECT_EQ(of_paper->bundled->stem(), "e2lf-n4-geometry");
  EXPECT_EQ(of_paper->codes->stated_by, StatedBy::kEvents);
  EXPECT_TRUE(of_paper->are_patterns_the_models());
  EXPECT_EQ(of_paper->camera_stated_by, StatedBy::kEvents);

  const auto of_pixels = open_method({.codes = codes, .events = {.camera = pixel_camera()}});
  ASSERT_TRUE(of_pixels) << of_pixels.error().text();
  EXPECT_EQ(of_pixels->network->model().name, "e2lf-n4-geometry-camera");
  EXPECT_EQ(of_pixels->codes->stated_by, StatedBy::kCaller);
  EXPECT_EQ(of_pixels->camera_stated_by, StatedBy::kEvents);

  const auto of_eight = open_method({.codes = *bundled("e2lf-n8").codes, .events = {.camera = pixel_camera()}});
  ASSERT_TRUE(of_eight) << of_eight.error().text();
  EXPECT_EQ(of_eight->network->model().name, "e2lf-n8-geometry-camera");
}

TEST(OpenMethod, TakesPhysicalPixelsWithTheDefaultProfileForEventsOfAnUnknownSensor) {
  const auto of_camera = open_method({.events = {.codes = *bundled("e2lf-n4").codes}});
  ASSERT_TRUE(of_camera) << of_camera.error().text();
  EXPECT_EQ(of_camera->network->model().name, "e2lf-n4-geometry-camera");
  EXPECT_EQ(of_camera->camera_stated_by, StatedBy::kModel);
  EXPECT_EQ(of_camera->camera->name, pixel_camera().name);
  EXPECT_FALSE(of_camera->complete({.black = std::nullopt}).black);
}

/// The choice for each kind of patterns, sensor, output and pace.
TEST(OpenMethod, ChoosesAmongTheBundledModelsByWhatTheyState) {
  const capture::Codes four = *bundled("e2lf-n4").codes, eight = *bundled("e2lf-n8").codes,
                       cycle = *bundled("e2lf-n4-cycle").codes;
  const auto name_for = [](const capture::Codes& codes, const capture::SensorProfile& camera, MethodChoice choice) {
    choice.codes = codes;
    choice.events.camera = camera;
    const auto opened = open_method(std::move(choice));
    return opened ? opened->network->model().name : opened.error().text();
  };
  const capture::SensorProfile paper, pixels = pixel_camera();
  EXPECT_EQ(name_for(four, paper, {}), "e2lf-n4-geometry");
  EXPECT_EQ(name_for(four, pixels, {}), "e2lf-n4-geometry-camera");
  EXPECT_EQ(name_for(cycle, paper, {}), "e2lf-n4-cycle-geometry");
  EXPECT_EQ(name_for(cycle, pixels, {}), "e2lf-n4-cycle-geometry-camera");
  EXPECT_EQ(name_for(eight, paper, {}), "e2lf-n8");
  EXPECT_EQ(name_for(eight, pixels, {}), "e2lf-n8-geometry-camera");
  for (const auto& camera : {paper, pixels}) {
    EXPECT_EQ(name_for(four, camera, {.prefers_fast = true}), "e2lf-n4-live");
    EXPECT_EQ(name_for(four, camera, {.algorithm = Algorithm::kDepth}), "e2lf-n4-depth");
    EXPECT_EQ(name_for(cycle, camera, {.algorithm = Algorithm::kDepth}), "e2lf-n4-cycle-depth");
  }
  EXPECT_EQ(name_for(eight, paper, {.prefers_fast = true}), "e2lf-n8");
  EXPECT_EQ(name_for(eight, pixels, {.prefers_fast = true}), "e2lf-n8-camera");
  EXPECT_EQ(name_for(cycle, paper, {.prefers_fast = true}), "e2lf-n4-cycle");
  EXPECT_EQ(name_for(cycle, pixels, {.prefers_fast = true}), "e2lf-n4-cycle-camera");
  capture::Codes others = four;
  std::swap_ranges(others.pattern(1).begin(), others.pattern(1).end(), others.pattern(2).begin());
  for (const auto& camera : {paper, pixels}) {
    EXPECT_EQ(name_for(others, camera, {}), "e2lf-any");
    EXPECT_EQ(name_for(others, camera, {.prefers_fast = true}), "e2lf-any");
    EXPECT_EQ(name_for(others, camera, {.algorithm = Algorithm::kDepth}), "e2lf-depth");
    EXPECT_EQ(name_for(capture::whole_cycle(others), camera, {.algorithm = Algorithm::kDepth}), "e2lf-depth-first");
  }
}

TEST(OpenMethod, NamesWhatDoesNotFitTheNumberOfEventImages) {
  EXPECT_EQ(open_method({.codes = bundled("e2lf-n8").codes, .transitions = 3}).error().option, "codes");
  EXPECT_EQ(open_method({.model = bundled("e2lf-n8"), .transitions = 3}).error().option, "model");
}

TEST(OpenMethod, DoesNotKnowWhetherThePatternsAreThoseOfViewsThatStateNone) {
  const auto opened = open_method({.model = bundled("e2lf-n4-capture-geometry"), .codes = bundled("e2lf-n4").codes});
  ASSERT_TRUE(opened) << opened.error().text();
  EXPECT_EQ(opened->network->model().codes, bundled("e2lf-n4").codes);
  EXPECT_FALSE(opened->are_patterns_the_models());
  EXPECT_TRUE(diagnose::contains(opened->findings, "patterns-unstated"));
}

TEST(Catalogue, NamesTheConditionedNetworksForThePatternsAndTheOutput) {
  const capture::Codes cycle = *bundled("e2lf-n4-cycle").codes;
  const std::string of_lit = conditioned_network_remedy(*bundled("e2lf-n4").codes, false);
  EXPECT_THAT(of_lit, HasSubstr("e2lf-n4-camera or e2lf-n4-geometry-camera"));
  EXPECT_THAT(of_lit, Not(HasSubstr("cycle")));
  EXPECT_THAT(of_lit, Not(HasSubstr("depth")));
  EXPECT_THAT(conditioned_network_remedy(cycle, false), HasSubstr("e2lf-n4-cycle-camera"));
  EXPECT_THAT(conditioned_network_remedy(cycle, true), HasSubstr("e2lf-n4-cycle-depth"));
  capture::Codes foreign = cycle;
  std::ranges::reverse(foreign.values);
  EXPECT_THAT(conditioned_network_remedy(foreign, false), HasSubstr("no bundled network is suitable"));
}

/// The message for sums of cycles and the finding about physical pixels name what to type, for light fields of each
/// kind of cycle.
TEST(OpenMethod, NamesTheNetworkThatTakesWhatAnotherDoesNot) {
  for (const auto& [name, remedy] : {std::pair("e2lf-n4", "e2lf-n4-camera"),
                                     {"e2lf-n8", "e2lf-n8-camera"},
                                     {"e2lf-n4-cycle", "e2lf-n4-cycle-camera"}}) {
    const OpenedMethod method = open_method({.model = bundled(name), .events = {.camera = pixel_camera()}}).value();
    EXPECT_THAT(method.ready({.cycles = 6}).error().message, HasSubstr(remedy)) << name;
    const diagnose::Findings& findings = method.findings;
    const auto foreign = std::ranges::find(findings, "pixels-foreign", &diagnose::Finding::code);
    ASSERT_NE(foreign, findings.end()) << name;
    EXPECT_THAT(foreign->remedy, HasSubstr(remedy)) << name;
  }
}

TEST(GainFinding, TellsAGainFarFromOneWithWhatToDoAboutIt) {
  const OpenedMethod of_paper = open_method({.model = bundled("e2lf-n4")}).value();
  const OpenedMethod of_pixels = open_method({.model = bundled("e2lf-n4-camera")}).value();
  for (const float usual : {0.5F, 1.0F, 3.5F}) EXPECT_FALSE(gain_finding(of_paper, usual)) << usual;
  const auto of_dark = gain_finding(of_paper, 7.6F);
  ASSERT_TRUE(of_dark);
  EXPECT_EQ(of_dark->code, "gain-unusual");
  EXPECT_THAT(of_dark->remedy, HasSubstr("e2lf-n4-camera"));
  EXPECT_EQ(gain_finding(of_pixels, 7.6F)->option, "camera");
  EXPECT_TRUE(gain_finding(of_paper, 0.25F));
  const OpenedMethod of_others =
      open_method({.model = bundled("e2lf-n4"), .events = {.camera = pixel_camera()}}).value();
  EXPECT_FALSE(gain_finding(of_others, 7.6F)) << "a method for another sensor explains it";
}

TEST(OpenMethod, NamesNoNetworkForPatternsThatNoneWasTrainedFor) {
  capture::Codes codes = *bundled("e2lf-n4").codes;
  std::reverse(codes.values.begin(), codes.values.end());
  const Error not_black = open_method({.codes = codes}).error();
  EXPECT_EQ(not_black.code, ErrorCode::kNotFound);
  EXPECT_THAT(not_black.message, HasSubstr("do not begin with black"));
  EXPECT_EQ(open_method({.codes = capture::whole_cycle(other_patterns(8))}).error().option, "transitions");
  EXPECT_THAT(open_method({.codes = other_patterns(9)}).error().message,
              HasSubstr("at most 8x8, or use the inversion"));
  EXPECT_THAT(open_method({}).error().message, HasSubstr("patterns"));
}

TEST(OpenMethod, TakesPatternsForThoseOfTheirWholeCycle) {
  for (const auto algorithm : {Algorithm::kNetwork, Algorithm::kDepth, Algorithm::kInversion}) {
    const capture::Codes codes = *bundled("e2lf-n4").codes;
    const auto opened = open_method(
        {.algorithm = algorithm, .codes = codes, .events = {.camera = capture::SensorProfile()}, .transitions = 8});
    ASSERT_TRUE(opened) << opened.error().text();
    EXPECT_EQ(opened->codes->codes, capture::whole_cycle(codes));
    if (algorithm == Algorithm::kInversion) continue;
    EXPECT_THAT(opened->network->model().name, HasSubstr("e2lf-n4-cycle-"));
  }
}

TEST(OpenMethod, TellsTheNetworkTheFirstCameraThatThereIs) {
  capture::SensorProfile mine = pixel_camera();
  mine.name = "mine";
  const auto named = open_method({.model = bundled("e2lf-n4-camera"), .camera = mine});
  ASSERT_TRUE(named) << named.error().text();
  EXPECT_EQ(named->network->model().camera->name, "mine");
  EXPECT_EQ(named->models_camera->name, pixel_camera().name);
  const auto of_model = open_method({.model = bundled("e2lf-n4-camera")});
  EXPECT_EQ(of_model->camera_stated_by, StatedBy::kModel);
  EXPECT_EQ(of_model->camera->name, pixel_camera().name);
  EXPECT_FALSE(of_model->models_camera);
  EXPECT_EQ(open_method({.model = bundled("e2lf-n4"), .camera = mine}).error().option, "camera");
}

TEST(OpenMethod, OpensTheNetworkOfTheLitTransitionsBesideThatOfTheWholeCycle) {
  const auto opened = open_method({.model = bundled("e2lf-n4-cycle-camera"), .lit_where_moving = true});
  ASSERT_TRUE(opened) << opened.error().text();
  ASSERT_TRUE(opened->lit);
  EXPECT_EQ(opened->lit->model().name, "e2lf-n4-camera");
  EXPECT_EQ(opened->lit->model().camera->name, opened->camera->name);
  EXPECT_FALSE(open_method({.model = bundled("e2lf-n4-cycle-camera")})->lit);
  EXPECT_FALSE(open_method({.model = bundled("e2lf-n4-camera"), .lit_where_moving = true})->lit);

  // For other patterns, it is the one for any patterns, adapted to them.
  model::Model of_others = bundled("e2lf-n4-cycle-geometry");
  capture::Codes lit = *capture::codes_of_whole_cycle(*of_others.codes);
  std::ranges::swap_ranges(lit.pattern(1), lit.pattern(2));
  of_others.codes = capture::whole_cycle(lit);
  const auto adapted = open_method({.model = of_others, .lit_where_moving = true});
  ASSERT_TRUE(adapted) << adapted.error().text();
  ASSERT_TRUE(adapted->lit);
  EXPECT_EQ(adapted->lit->model().name, "e2lf-any");
  EXPECT_EQ(adapted->lit->model().codes, lit);
}

TEST(OpenMethod, RefusesMeasurementsThatNeedANetworkOfTheirOwn) {
  const auto failed =
      open_method({.algorithm = Algorithm::kInversion, .measurement = capture::MeasurementKind::kCodedImages});
  EXPECT_THAT(failed.error().message, HasSubstr("measurement"));
}

TEST(OpenMethod, TheInversionIsThatOfReconAndTakesOneCycleAndPass) {
  const capture::EventImages images = some_events();
  const capture::Codes codes = capture::default_codes();
  const auto opened = open_method({.algorithm = Algorithm::kInversion, .codes = codes});
  ASSERT_TRUE(opened) << opened.error().text();
  const auto field = opened->ready().value()(images, {});
  const auto expected = recon::reconstruct_by_inversion(images, codes, {});
  EXPECT_TRUE(std::ranges::equal(field.value().data(), expected.value().data()));
  EXPECT_EQ(opened->ready({.passes = 2}).error().option, "passes");
  EXPECT_EQ(opened->ready({.cycles = 2}).error().option, "cycles_per_field");
}

TEST(OpenMethod, PatternsOfNobodyAreTheUsualOnes) {
  const auto opened = open_method({.algorithm = Algorithm::kInversion});
  ASSERT_TRUE(opened) << opened.error().text();
  EXPECT_EQ(opened->codes->stated_by, StatedBy::kNone);
  EXPECT_EQ(opened->codes->codes, usual_patterns().value());
}

TEST(OpenSequence, FindsBlackOfPhysicalPixelsUnlessBrightnessIsMeasured) {
  const capture::Codes codes = *bundled("e2lf-n4").codes;
  const auto pixels = open_method({.algorithm = Algorithm::kInversion, .codes = codes, .camera = pixel_camera()});
  EXPECT_FALSE(open_sequence(*pixels, {.black = std::nullopt})->tone().black);
  EXPECT_EQ(open_sequence(*pixels, {.gain = 1.0F, .black = std::nullopt})->tone().black, 0.0F);
}

}  // namespace
}  // namespace e2lf::pipeline
