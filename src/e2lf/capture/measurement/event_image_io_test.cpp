// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/event_image_io.h"

#include <cmath>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <unistd.h>

#include "e2lf/files/file.h"

namespace e2lf::capture {
namespace {

namespace fs = std::filesystem;

class EventImageFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("e2lf_" + std::string(test->name()) + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  template <typename T>
  fs::path write(const std::string& name, std::vector<size_t> shape, const std::vector<T>& values) const {
    EXPECT_TRUE(write_npy(folder_ / name, make_npy(std::move(shape), std::span<const T>(values))));
    return folder_ / name;
  }
  static ErrorCode failure(const fs::path& path) {
    const auto read = read_event_images(path);
    return read ? ErrorCode::kInternal : read.error().code;
  }

  fs::path folder_;
};

EventImages ramp(int16_t first) {
  EventImages images(2, 3, 5);
  for (auto& count : images.values) count = first++;
  return images;
}

TEST_F(EventImageFiles, ArchiveRoundTripKeepsCyclesAndCodes) {
  EventImageFile file;
  file.cycles = {ramp(-20), ramp(std::numeric_limits<int16_t>::max() - 29)};
  file.setup.codes = Codes(3, 8, 8);
  file.setup.codes->values[70] = 0.5F;
  file.setup.views = Orientation{true, false};
  ASSERT_TRUE(write_event_images(folder_ / "events.npz", file));

  const auto read = read_event_images(folder_ / "events.npz");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->cycles, file.cycles);
  EXPECT_EQ(read->setup.codes, file.setup.codes);
  EXPECT_EQ(read->setup.views, file.setup.views);
  EXPECT_FALSE(read->setup.camera);
}

TEST_F(EventImageFiles, ThreeAxesAreOneCycleOfAnyNumericType) {
  EventImages expected(1, 2, 2);
  expected.values = {1, -2, 3, 0};
  for (const auto& path :
       {write<float>("f.npy", {1, 2, 2}, {1, -2, 3, 0}), write<int32_t>("i.npy", {1, 1, 2, 2}, {1, -2, 3, 0})}) {
    const auto read = read_event_images(path);
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->cycles, std::vector<EventImages>{expected});
    EXPECT_FALSE(read->setup.codes);
  }
}

TEST_F(EventImageFiles, A14A15WhatIsNoCountIsNamedWithItsPlace) {
  const auto text = [](const fs::path& path) { return read_event_images(path).error().text(); };
  const std::string nan = text(write<float>("nan.npy", {1, 2, 2}, {0, 1, std::nanf(""), 2}));
  EXPECT_THAT(nan, testing::AllOf(testing::HasSubstr("NaN"), testing::HasSubstr("at [0, 1, 0]")));
  EXPECT_THAT(text(write<double>("part.npy", {1, 2, 2}, {0, 1, 2, -0.5})), testing::HasSubstr("-0.5 at [0, 1, 1]"));
  EXPECT_THAT(text(write<uint8_t>("u1.npy", {1, 2, 2}, {0, 255, 1, 2})), testing::HasSubstr("-1 became 255"));
  EXPECT_THAT(text(write<uint16_t>("u2.npy", {1, 2, 2}, {0, 65535, 1, 2})), testing::HasSubstr("-1 became 65535"));
  EXPECT_TRUE(read_event_images(write<uint8_t>("small.npy", {1, 2, 2}, {0, 100, 1, 2})));
}

TEST_F(EventImageFiles, A14TransposedAxesAreRefused) {
  const std::vector<int16_t> counts(48 * 64 * 3, 1);
  const Error error = read_event_images(write<int16_t>("yxn.npy", {48, 64, 3}, counts)).error();
  EXPECT_EQ(error.code, ErrorCode::kShape);
  EXPECT_THAT(error.text(), testing::HasSubstr("[48, 64, 3]"));
  EXPECT_FALSE(read_event_images(write<int16_t>("cyxn.npy", {1, 48, 64, 3}, counts)));
}

TEST_F(EventImageFiles, FolderIsReadInNumberOrder) {
  // Eleven images, so that an alphabetical order of unpadded numbers would be wrong.
  for (int32_t i = 0; i < 11; ++i) write<int32_t>("event_image_" + std::to_string(i) + ".npy", {1, 2, 1}, {i, -i});
  write<float>("other.npy", {1}, {0});
  const auto read = read_event_images(folder_);
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_EQ(read->cycles.size(), 1U);
  const EventImages& cycle = read->cycles[0];
  EXPECT_EQ(cycle.count, 11U);
  EXPECT_EQ(cycle.height, 1U);
  EXPECT_EQ(cycle.width, 2U);
  for (int16_t i = 0; i < 11; ++i) {
    EXPECT_EQ(cycle.image(i)[0], i);
    EXPECT_EQ(cycle.image(i)[1], -i);
  }
}

TEST_F(EventImageFiles, BadValuesAreNamed) {
  EXPECT_EQ(failure(write<float>("nan.npy", {1, 1, 2}, {0, std::numeric_limits<float>::quiet_NaN()})),
            ErrorCode::kInvalidValue);
  EXPECT_EQ(failure(write<float>("half.npy", {1, 1, 2}, {0, 0.5F})), ErrorCode::kInvalidValue);
  EXPECT_EQ(failure(write<int32_t>("big.npy", {1, 1, 2}, {0, 32768})), ErrorCode::kInvalidValue);
  EXPECT_EQ(failure(write<int32_t>("small.npy", {1, 1, 2}, {0, -32769})), ErrorCode::kInvalidValue);
}

TEST_F(EventImageFiles, BadShapesAreNamed) {
  EXPECT_EQ(failure(write<int32_t>("flat.npy", {2, 2}, {0, 0, 0, 0})), ErrorCode::kShape);
  EXPECT_EQ(failure(write<int32_t>("none.npy", {0, 2, 2}, {})), ErrorCode::kShape);

  ASSERT_TRUE(write_event_images(folder_ / "codes.npz", {{ramp(0)}, {Codes(4, 8, 8), {}, {}}}));
  EXPECT_EQ(failure(folder_ / "codes.npz"), ErrorCode::kShape);
}

TEST_F(EventImageFiles, WrongSetupsAreNamed) {
  const std::vector<float> codes(3 * 64, 2.0F);
  const std::vector<int16_t> counts(24);
  const NpyArray events = make_npy<int16_t>({2, 3, 4}, counts);
  ASSERT_TRUE(write_npz(folder_ / "bright.npz", {{"events", events}, {"codes", make_npy<float>({3, 8, 8}, codes)}}));
  const Error error = read_event_images(folder_ / "bright.npz").error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
  EXPECT_THAT(error.location, testing::HasSubstr("bright.npz: codes"));
  const NpyArray text = make_npy<uint8_t>({1}, std::vector<uint8_t>{'?'});
  for (const char* name : {"camera", "views"}) {
    ASSERT_TRUE(write_npz(folder_ / "bad.npz", {{"events", events}, {name, text}}));
    EXPECT_THAT(read_event_images(folder_ / "bad.npz").error().location, testing::HasSubstr(name));
  }
}

TEST_F(EventImageFiles, NamesInAFolderWithoutANumberFromZeroAreRefused) {
  write<int32_t>("event_image_0.npy", {1, 2}, {0, 0});
  ASSERT_TRUE(read_event_images(folder_));
  for (const char* name : {"event_image_-1.npy", "event_image_0_old.npy", "event_image_.npy"}) {
    const fs::path file = write<int32_t>(name, {1, 2}, {0, 0});
    const auto read = read_event_images(folder_);
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().location, file.string());
    fs::remove(file);
  }
}

TEST_F(EventImageFiles, FolderProblemsAreNamed) {
  EXPECT_EQ(failure(folder_), ErrorCode::kNotFound);
  write<int32_t>("event_image_00000.npy", {1, 2}, {0, 0});
  write<int32_t>("event_image_00002.npy", {1, 2}, {0, 0});
  EXPECT_EQ(failure(folder_), ErrorCode::kNotFound);
  write<int32_t>("event_image_00001.npy", {2, 1}, {0, 0});
  EXPECT_EQ(failure(folder_), ErrorCode::kShape);
}

TEST_F(EventImageFiles, MissingAndForeignFilesAreNamed) {
  EXPECT_EQ(failure(folder_ / "absent.npz"), ErrorCode::kNotFound);
  EXPECT_EQ(failure(folder_ / "absent.txt"), ErrorCode::kNotFound);
  ASSERT_TRUE(write_file(folder_ / "events.txt", std::string("1 2 3\n")));
  EXPECT_EQ(failure(folder_ / "events.txt"), ErrorCode::kUnsupported);
  NpzArrays arrays;
  const std::vector<float> values(1);
  arrays["codes"] = make_npy(std::vector<size_t>{1}, std::span<const float>(values));
  ASSERT_TRUE(write_npz(folder_ / "no_events.npz", arrays));
  EXPECT_EQ(failure(folder_ / "no_events.npz"), ErrorCode::kNotFound);
}

TEST_F(EventImageFiles, ReleasedCaptureIsReadWhole) {
  const char* data = std::getenv("E2LF_DATA");
  const fs::path capture = fs::path(data != nullptr ? data : "") / "official/Animals";
  if (data == nullptr || !fs::exists(capture)) GTEST_SKIP() << "E2LF_DATA/official/Animals is absent";
  const auto read = read_event_images(capture);
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_EQ(read->cycles.size(), 1U);
  const EventImages& cycle = read->cycles[0];
  EXPECT_EQ(cycle.count, 3U);
  EXPECT_EQ(cycle.height, 720U);
  EXPECT_EQ(cycle.width, 1280U);
  double events = 0;
  for (const int16_t count : cycle.values) events += std::abs(count);
  EXPECT_NEAR(events / (720 * 1280), 1.9, 0.05);  // the documented density of this capture
}

}  // namespace
}  // namespace e2lf::capture
