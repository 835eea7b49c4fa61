// SPDX-License-Identifier: MIT
// Runs from event images by networks whose answers are known.
#include "e2lf/pipeline/event_run.h"

#include <gtest/gtest.h>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::pipeline {
namespace {

/// A network without a camera, each of whose outputs is half the first count.
model::Model half_of_first_count(size_t outputs) {
  model::Model model;
  model.name = "half";
  model.num_patterns = 4;
  model.input = {{model::InputKind::kCounts, 0.125F}};
  model.network = {3, {{.name = "out", .inputs = {"input"}, .out_channels = outputs}}};
  std::vector<float> weights(outputs * 3);
  for (size_t output = 0; output < outputs; ++output) weights[3 * output] = 4;
  model.weights = {{"out.weight", weights}, {"out.bias", std::vector<float>(outputs)}};
  model.codes = capture::default_codes();
  return model;
}

/// A file of cycles of 24x32 px, in each of which pixels have the counts 1 and 2.
capture::MeasurementFile file_of(size_t cycles) {
  capture::MeasurementFile file;
  capture::EventImages images(3, 24, 32);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(1 + i % 2);
  file.cycles.assign(cycles, capture::Measurement(images));
  return file;
}

EventRunOptions light_fields(MethodUse use = {}) {
  return {.method = {.model = half_of_first_count(64), .use = use}, .tone = {.gain = 1.0F}};
}

EventRunOptions maps() {
  return {.method = {.algorithm = Algorithm::kDepth, .model = half_of_first_count(2)}};
}

std::vector<std::string> codes_of(const diagnose::Findings& findings) {
  std::vector<std::string> codes;
  for (const diagnose::Finding& finding : findings) codes.push_back(finding.code);
  return codes;
}

TEST(EventRun, MakesALightFieldOfEachCycle) {
  EventRun run = EventRun::open(file_of(2), light_fields()).value();
  EXPECT_FALSE(run.input().has_one_field());
  for (size_t number = 0; number < 2; ++number) {
    const auto result = run.next().value();
    ASSERT_TRUE(result);
    EXPECT_EQ(result->number, number);
    EXPECT_FLOAT_EQ(std::get<Field>(result->made).light_field.data()[1], 1.0F);
    EXPECT_TRUE(result->error) << "the patterns of the model are assumed";
    EXPECT_EQ(result->check.has_value(), number == 0);
  }
  EXPECT_FALSE(run.next().value());
  EXPECT_EQ(run.report().results, 2U);
  EXPECT_TRUE(recordings::losses(run.report().left_out).empty());
}

TEST(EventRun, MakesAMapOfEachCycle) {
  EventRunOptions options = maps();
  options.turned = capture::kTurned;
  EventRun run = EventRun::open(file_of(1), options).value();
  EXPECT_TRUE(run.input().has_one_field());
  const auto result = run.next().value();
  const depth::DisparityMap& map = std::get<EventDepth>(result->made).map;
  EXPECT_FLOAT_EQ(map.disparity.pixels[1], -1.0F);
  EXPECT_EQ(map.view.y, 3U);
  EXPECT_FALSE(result->error || result->check);
}

TEST(EventRun, ReportsTheCyclesThatAreTooFewForAnotherSum) {
  EventRunOptions options = light_fields({.cycles = 3});
  options.method.model = read_network(bundled_file_named(kBundledModels, "e2lf-n4-camera").value()).value();
  EventRun run = EventRun::open(file_of(5), options).value();
  EXPECT_TRUE(run.input().has_one_field());
  EXPECT_TRUE(run.next().value());
  EXPECT_FALSE(run.next().value());
  EXPECT_EQ(run.report().results, 1U);
  EXPECT_EQ(run.report().left_out.left_over_cycles, 2U);
}

TEST(EventRun, DoesNotConfirmASumOfWhichACycleHasNoEvents) {
  EventRunOptions options = light_fields({.cycles = 3});
  options.method.model = read_network(bundled_file_named(kBundledModels, "e2lf-n4-camera").value()).value();
  capture::MeasurementFile file = file_of(3);
  EventRun whole = EventRun::open(file, options).value();
  EXPECT_FALSE(diagnose::contains(whole.next().value()->findings, "events-absent"));
  std::ranges::fill(file.cycles[1].events.values, int16_t{0});
  EventRun run = EventRun::open(file, options).value();
  const auto result = run.next().value();
  EXPECT_FALSE(result->is_confirmed);
  EXPECT_TRUE(diagnose::contains(result->findings, "events-absent"));
}

TEST(EventRun, CollectsWhatMayBeWrong) {
  capture::MeasurementFile file = file_of(1);
  file.setup.findings =
      json_line(diagnose::to_json(diagnose::Findings{{"polarity-inverted", diagnose::Severity::kError, "m", "r"}}));
  for (const EventRunOptions& options : {light_fields({.passes = 3}), maps()}) {
    EventRun run = EventRun::open(file, options).value();
    const std::vector<std::string> at_first = codes_of(run.report().findings);
    EXPECT_EQ(at_first.at(0), "polarity-inverted");
    EXPECT_EQ(at_first.at(1), "patterns-assumed");
    const auto result = run.next().value();
    EXPECT_FALSE(result->is_confirmed);
    // Counts of a single sign are no scene.
    EXPECT_TRUE(diagnose::contains(result->findings, "sign-lost"));
    EXPECT_TRUE(diagnose::contains(run.report().findings, "sign-lost"));
  }
}

TEST(EventRun, ReportsAnUnusualGainThatItDetermines) {
  EventRunOptions options = light_fields();
  for (float& weight : options.method.model->weights.at("out.weight")) weight /= 10;
  for (const auto& [gain, is_told] : {std::pair(std::optional(9.0F), false), {std::optional<float>(), true}}) {
    options.tone.gain = gain;
    EventRun run = EventRun::open(file_of(2), options).value();
    EXPECT_EQ(diagnose::contains(run.next()->value().findings, "gain-unusual"), is_told);
    EXPECT_FALSE(diagnose::contains(run.next()->value().findings, "gain-unusual")) << "once";
    EXPECT_EQ(diagnose::contains(run.report().findings, "gain-unusual"), is_told);
    EXPECT_FLOAT_EQ(*run.report().tone.gain, 9.0F);
  }
}

TEST(EventRun, TellsPatternsOfOthers) {
  capture::MeasurementFile file = file_of(1);
  file.setup.codes = capture::default_codes();
  EXPECT_TRUE(codes_of(EventRun::open(file, maps())->report().findings).empty());
  std::swap(file.setup.codes->values[0], file.setup.codes->values[64]);
  file.setup.codes->values[70] = 1 - file.setup.codes->values[70];
  EXPECT_EQ(codes_of(EventRun::open(file, maps())->report().findings), std::vector<std::string>{"patterns-foreign"});
  EventRunOptions options = maps();
  options.method.codes = capture::default_codes();
  EXPECT_EQ(codes_of(EventRun::open(file, options)->report().findings),
            std::vector<std::string>{"patterns-contradicted"});
}

TEST(EventRun, RefusesWhatDoesNotApply) {
  capture::MeasurementFile dark = file_of(1);
  for (int16_t& count : dark.cycles[0].events.values) count = 0;
  EXPECT_EQ(EventRun::open(dark, light_fields()).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(EventRun::open(dark, maps()).error().code, ErrorCode::kInvalidValue);
  EventRunOptions options = maps();
  options.events.schedule.transitions = "lit";
  EXPECT_EQ(EventRun::open(file_of(1), options).error().option, "transitions");
  for (EventRunOptions each : {light_fields(), maps()}) {
    each.method.use = {.fused_cycles = 2};
    EXPECT_EQ(EventRun::open(file_of(2), each).error().option, "fuse");
    each.method.use = {.cycles = 2};
    EXPECT_EQ(EventRun::open(file_of(2), each).error().option, "cycles_per_field");
  }
}

}  // namespace
}  // namespace e2lf::pipeline
