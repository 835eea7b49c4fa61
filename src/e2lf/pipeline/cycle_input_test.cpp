// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/cycle_input.h"

#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/recordings/live/camera.h"
#include "testing/test_files.h"

namespace e2lf::pipeline {
namespace {

/// Returns a file with one cycle of one pixel for each count.
capture::MeasurementFile file_of(const std::vector<int16_t>& counts) {
  capture::MeasurementFile file;
  for (const int16_t count : counts) {
    capture::EventImages images(1, 1, 1);
    images.values[0] = count;
    file.cycles.emplace_back(std::move(images));
  }
  return file;
}

TEST(CycleInput, SumsTheCyclesOfALightFieldAndLeavesFewerOut) {
  CycleInput input = CycleInput::open(file_of({1, 2, 3, 4, 5}), {.cycles_per_field = 2}).value();
  EXPECT_FALSE(input.has_one_field());
  EXPECT_EQ(input.next().value()->images.events.values[0], 3);
  EXPECT_EQ(input.next().value()->images.events.values[0], 7);
  EXPECT_EQ(input.summary().left_over_cycles, 0U);
  EXPECT_FALSE(input.next().value());
  EXPECT_EQ(input.summary().left_over_cycles, 1U);
  EXPECT_EQ(recordings::losses(input.summary()).at(0).reason, "left_over_cycles");
  EXPECT_TRUE(CycleInput::open(file_of({1, 2, 3}), {.cycles_per_field = 2})->has_one_field());
}

TEST(CycleInput, CountsTheCyclesWithoutEventsOfASum) {
  CycleInput input = CycleInput::open(file_of({1, 0, 2, 3, 4, 5}), {.cycles_per_field = 3}).value();
  EXPECT_EQ(input.next().value()->without_events, 1U);
  EXPECT_EQ(input.next().value()->without_events, 0U);
}

TEST(CycleInput, CountsWhatSumsHaveNoRoomFor) {
  CycleInput input = CycleInput::open(file_of({INT16_MAX, 2}), {.cycles_per_field = 2}).value();
  EXPECT_EQ(input.next().value()->images.events.values[0], INT16_MAX);
  EXPECT_EQ(input.summary().saturated, 2U);
  EXPECT_FALSE(CycleInput::open(file_of({INT16_MAX, 2}), {.cycles_per_field = 2, .is_strict = true})->next());
}

TEST(CycleInput, InvertsAndEndsAfterAsManyCyclesAsAskedFor) {
  CycleInput input =
      CycleInput::open(file_of({INT16_MIN, 5}), {.max_cycles = 1, .cycles = {.invert_polarity = true}}).value();
  EXPECT_EQ(input.next().value()->images.events.values[0], INT16_MAX);
  EXPECT_FALSE(input.next().value());
}

TEST(CycleInput, ErrorsNameTheOption) {
  const auto option = [](capture::MeasurementFile file, const CycleInputOptions& options) {
    return CycleInput::open(std::move(file), options).error().option;
  };
  EXPECT_EQ(option(file_of({1, 2, 3}), {.cycles_per_field = 3, .max_cycles = 2}), "max_cycles");
  EXPECT_EQ(option(file_of({1}), {.cycles_per_field = 2}), "cycles_per_field");
  const auto fused = CycleInput::open(file_of({1, 2}), {.cycles_per_field = 2}).value().fuse({}, 2);
  EXPECT_EQ(fused.error().option, "fuse");
  EXPECT_NE(fused.error().message.find("omit this option"), std::string::npos);
  capture::MeasurementFile images = file_of({1, 1});
  for (auto& cycle : images.cycles) cycle.kind = capture::MeasurementKind::kCodedImages;
  EXPECT_EQ(option(images, {.cycles_per_field = 2}), "cycles_per_field");
  EXPECT_EQ(option(images, {.cycles = {.invert_polarity = true}}), "invert_polarity");
}

TEST(CycleInput, TellsLitTransitionsFromThoseOfAWholeCycle) {
  const auto opened = [](size_t transitions, const std::optional<capture::Codes>& codes, const char* wanted) {
    capture::MeasurementFile file = file_of({1});
    file.cycles[0].events = capture::EventImages(transitions, 1, 1);
    file.setup.codes = codes;
    return CycleInput::open(std::move(file), {.schedule = {.transitions = wanted}});
  };
  const capture::Codes four = capture::default_codes(), whole = capture::whole_cycle(four);
  for (const char* wanted : {"auto", "lit"}) EXPECT_TRUE(opened(3, four, wanted)) << wanted;
  EXPECT_EQ(opened(3, four, "all").error().option, "transitions");
  EXPECT_EQ(opened(3, {}, "all").error().option, "transitions");
  EXPECT_TRUE(opened(8, whole, "all"));
  EXPECT_TRUE(opened(8, four, "all"));
  EXPECT_TRUE(opened(8, {}, "all"));
  EXPECT_EQ(opened(8, whole, "lit")->check_transitions().error().option, "transitions");
}

TEST(RecordedSetup, IsThatOfTheRecordingThatIsReplayed) {
  recordings::add_camera_plugin({"any", "a camera that is not opened"});
  const TestFolder folder;
  const std::filesystem::path recording = folder / "a.npy";
  ASSERT_TRUE(write_file(recording, std::string("events")));
  const capture::RecordedSetup written{.views = capture::kTurned};
  const Json record = {{"written_by", "e2lf"}, {"notes", setup_notes(written, recording)}};
  ASSERT_TRUE(write_file(record_path_beside(recording), json_text(record)));
  for (const char* name : {"", "replay:", "camera://replay/"}) {
    const auto setup = recorded_setup(name + recording.string(), {}).value();
    ASSERT_TRUE(setup.views.has_value()) << name;
    EXPECT_EQ(*setup.views, capture::kTurned);
  }
}

}  // namespace
}  // namespace e2lf::pipeline
