// SPDX-License-Identifier: MIT
#include "e2lf/recordings/convert.h"

#include <cstdio>
#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/event_counters.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

Result<EventBatch> read(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(path));
  return read_all(*reader);
}

Result<ConvertReport> convert(const std::filesystem::path& from, const std::filesystem::path& to) {
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(from));
  return convert_recording(*reader, to);
}

/// A file of random events with triggers in a format that holds both.
std::filesystem::path write_example(const TestFolder& folder, const EventBatch& batch) {
  write_recording(folder / "start.hdf5", batch, {.width = 640, .height = 480});
  return folder / "start.hdf5";
}

TEST(Convert, EventsAndTriggersSurviveAChainThroughEveryFormat) {
  TestFolder folder;
  RandomStream stream = {.events = 20000, .trigger_every = 400};
  const EventBatch batch = random_stream(stream);
  std::filesystem::path last = write_example(folder, batch);
  int step = 0;
  for (const char* extension : {"csv", "raw", "dat", "hdf5", "npz"}) {
    const auto next = folder / ("step" + std::to_string(step++) + "." + extension);
    auto report = convert(last, next);
    ASSERT_TRUE(report.ok()) << extension << ": " << report.error().text();
    EXPECT_EQ(report->events, batch.events.size());
    EXPECT_EQ(report->triggers, batch.triggers.size());
    auto back = read(next);
    ASSERT_TRUE(back.ok()) << extension << ": " << back.error().text();
    EXPECT_TRUE(back->events == batch.events) << extension;
    EXPECT_EQ(back->triggers, batch.triggers) << extension;
    last = next;
  }
}

TEST(Convert, TriggersWithoutAPlaceGoToAFileBesideWithAWarning) {
  TestFolder folder;
  RandomStream stream = {.trigger_every = 100};
  const auto from = write_example(folder, random_stream(stream));
  auto report = convert(from, folder / "out.csv");
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->trigger_file, "out_triggers.csv");
  EXPECT_TRUE(std::filesystem::exists(folder / report->trigger_file));
  EXPECT_EQ(report->warnings.size(), 1u);
  EXPECT_TRUE(convert(from, folder / "out2.hdf5")->warnings.empty());
}

TEST(Convert, TriggersBesideAreReadInAnyOrderAndDamagedLinesAreCounted) {
  TestFolder folder;
  const auto from = write_example(folder, random_stream({.trigger_every = 100}));
  ASSERT_TRUE(convert(from, folder / "out.csv").ok());
  ASSERT_TRUE(write_file(folder / "out_triggers.csv", std::string("p,id,t\n1,0,3000\nrubbish\n0,2,1500\n")).ok());
  auto reader = open_recording(folder / "out.csv", {.policy = DecodePolicy::kSkip}).value();
  const std::vector<Trigger> expected = {{1500, 2, 0}, {3000, 0, 1}};
  EXPECT_EQ(read_all(*reader)->triggers, expected);
  const std::vector<Loss> left_out = losses(reader->summary());
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_EQ(left_out[0].reason, "bad_record");
  EXPECT_EQ(left_out[0].count, 1u);
  EXPECT_EQ(left_out[0].first_byte, 16u);
  auto strict = open_recording(folder / "out.csv", {.policy = DecodePolicy::kStrict}).value();
  EXPECT_EQ(read_all(*strict).error().code, ErrorCode::kFormat);
}

TEST(Convert, TriggersBesideInOtherColumnsOrUnitsAreRefusedOrCounted) {
  TestFolder folder;
  const auto from = write_example(folder, random_stream({.trigger_every = 100}));
  ASSERT_TRUE(convert(from, folder / "out.csv").ok());
  const auto path = folder / "out_triggers.csv";
  for (const char* names : {"p,t,id", "p,id,t_ns", "t,p,id"}) {
    ASSERT_TRUE(write_file(path, cat(names, "\n1,0,3000\n")).ok());
    const auto reader = open_recording(folder / "out.csv", {.policy = DecodePolicy::kSkip});
    ASSERT_FALSE(reader.ok()) << names;
    EXPECT_EQ(reader.error().location, path.string());
  }
  ASSERT_TRUE(write_file(path, std::string("\xEF\xBB\xBFp, id, t\r\n1, 0, 3000\r\n1,0,0.002\n")).ok());
  auto reader = open_recording(folder / "out.csv", {.policy = DecodePolicy::kSkip}).value();
  EXPECT_EQ(read_all(*reader)->triggers, (std::vector<Trigger>{{3000, 0, 1}}));
  EXPECT_EQ(reader->summary().of(Violation::kBadRecord).count, 1U);
}

TEST(Convert, WhatIsLeftOutIsReportedAndNothingIsNoResult) {
  TestFolder folder;
  const std::string text = "x,y,p,t\n1,1,1,50\n700,1,1,60\n1,1,0,40\nthis is no event\n2,2,1,70\n";
  ASSERT_TRUE(write_file(folder / "in.csv", text).ok());
  const auto open = [&](OpenOptions options) {
    options.policy = DecodePolicy::kSkip;
    options.width = 640;
    options.height = 480;
    return open_recording(folder / "in.csv", options).value();
  };
  const auto all = open({});
  const ConvertReport report = convert_recording(*all, folder / "out.npz").value();
  EXPECT_EQ(report.events, 3u);
  EXPECT_EQ(report.summary.out_of_order, 1u);
  EXPECT_EQ(loss_text(losses(report.summary)),
            "1 events outside the sensor, 1 records that cannot be read (the first at byte 37)");

  const auto relative = open({.from_us = 10, .to_us = 31, .range = TimeOrigin::kZero});
  EXPECT_EQ(read_all(*relative)->events.t, (Column<int64_t>{50, 70}));
  const auto shifted = open({.time = TimeOrigin::kZero, .from_us = 50, .to_us = 70});
  EXPECT_EQ(read_all(*shifted)->events.t, (Column<int64_t>{10}));

  const auto later = open({.from_us = 1000});
  const auto none = convert_recording(*later, folder / "none.npz");
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::kInvalidValue);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.npz"));
}

TEST(Convert, TextHasTheOrderAndUnitsItsUsersExpect) {
  TestFolder folder;
  EventBatch batch;
  batch.events.push_back({12, 345, 1, 0});
  batch.events.push_back({639, 0, 0, 9999});
  batch.events.push_back({0, 479, 1, 12345678});
  const auto from = write_example(folder, batch);
  ASSERT_TRUE(convert(from, folder / "out.csv").ok());
  const auto text = [&](const char* name) {
    auto bytes = read_file(folder / name);
    return std::string(bytes->begin(), bytes->end());
  };
  EXPECT_EQ(text("out.csv"), "%geometry:640,480\n12,345,1,0\n639,0,0,9999\n0,479,1,12345678\n");
}

TEST(Convert, Hdf5OpensInTheVendorNeutralTools) {
  if (std::system("h5dump --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "h5dump is not installed";
  TestFolder folder;
  RandomStream stream = {.trigger_every = 100};
  const auto path = write_example(folder, random_stream(stream));
  const std::string command = "h5dump -p -d CD/indexes -d EXT_TRIGGER/events '" + path.string() +
                              "' 2>&1 && h5dump -p -H '" + path.string() + "' 2>&1";
  std::string text;
  FILE* pipe = ::popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0);
  EXPECT_NE(text.find("FILTER_ID 36559"), std::string::npos);
  EXPECT_NE(text.find("geometry"), std::string::npos);
}

TEST(EventRate, BinsHoldEveryEventOfAnyLength) {
  EventRateCounter counter(64);
  RandomStream stream = {.events = 5000, .trigger_every = 10};
  for (uint32_t part = 0; part < 20; ++part) {
    stream.begin_us = 1000 + part * 1'000'000;
    counter.add(random_stream(stream));
    EXPECT_LE(counter.rate().size(), 64u);
  }
  const EventRate& rate = counter.rate();
  const auto sum = [](const std::vector<uint64_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), uint64_t{0});
  };
  EXPECT_EQ(sum(rate.on) + sum(rate.off), 100000u);
  EXPECT_EQ(sum(rate.triggers), 10000u);
  EXPECT_GE(static_cast<int64_t>(rate.size()) * rate.bin_us, 19'000'000);
  EXPECT_GT(rate.size(), 32u);
}

}  // namespace
}  // namespace e2lf::recordings
