// SPDX-License-Identifier: MIT
#include <filesystem>
#include <gtest/gtest.h>
#include <unistd.h>

#include "e2lf/base/rng.h"
#include "e2lf/capture/measurement/event_image_io.h"

namespace e2lf::capture {
namespace {

namespace fs = std::filesystem;

EventImages random_images(uint64_t seed) {
  EventImages images(3, 17, 29);
  const CounterRng rng(seed, 0);
  for (size_t i = 0; i < images.values.size(); ++i) {
    images.values[i] = static_cast<int16_t>(static_cast<int>(rng.below(i, 4001)) - 2000);
  }
  return images;
}

RecordedSetup test_setup() {
  RecordedSetup setup{Codes(4, 1, 2), SensorProfile(), kTurned};
  setup.codes->values = {0.0F, 0.0F, 1.0F, 0.5F, 0.0F, 1.0F, 1.0F, 1.0F};
  setup.camera->name = "mine";
  return setup;
}

void expect_test_setup(const RecordedSetup& found) {
  EXPECT_EQ(found.codes, test_setup().codes);
  ASSERT_TRUE(found.camera);
  EXPECT_EQ(found.camera->name, "mine");
  EXPECT_EQ(found.views, kTurned);
}

fs::path test_path(const std::string& name) {
  return fs::path(testing::TempDir()) / (std::to_string(::getpid()) + "_" + name);
}

TEST(EventImageWriter, WritesWhatReadEventImagesReads) {
  const fs::path path = test_path("event_image_writer.npz");
  fs::remove(path);
  auto writer = EventImageWriter::create(path);
  ASSERT_TRUE(writer) << writer.error().text();
  for (uint64_t cycle = 0; cycle < 5; ++cycle) ASSERT_TRUE((*writer)->add(random_images(cycle)));
  EXPECT_FALSE(fs::exists(path));
  const auto finished = (*writer)->finish();
  ASSERT_TRUE(finished) << finished.error().text();
  const auto file = read_event_images(path);
  ASSERT_TRUE(file) << file.error().text();
  ASSERT_EQ(file->cycles.size(), 5U);
  for (uint64_t cycle = 0; cycle < 5; ++cycle) EXPECT_EQ(file->cycles[cycle], random_images(cycle));
  fs::remove(path);
}

TEST(EventImageWriter, KeepsThePatternsBesideTheEvents) {
  const fs::path path = test_path("event_image_writer_codes.npz");
  auto writer = EventImageWriter::create(path);
  ASSERT_TRUE(writer) << writer.error().text();
  (*writer)->keep(test_setup());
  ASSERT_TRUE((*writer)->add(random_images(1)));
  ASSERT_TRUE((*writer)->finish());
  const auto file = read_event_images(path);
  ASSERT_TRUE(file) << file.error().text();
  EXPECT_EQ(file->cycles.at(0), random_images(1));
  expect_test_setup(file->setup);
  fs::remove(path);
}

TEST(EventImageWriter, LeavesNothingBehindWithoutFinish) {
  const fs::path folder = test_path("event_image_writer_folder");
  fs::remove_all(folder);
  {
    auto writer = EventImageWriter::create(folder / "a.npz");
    ASSERT_TRUE(writer);
    ASSERT_TRUE((*writer)->add(random_images(1)));
  }
  EXPECT_TRUE(fs::is_empty(folder));
  fs::remove_all(folder);
}

TEST(EventImageWriter, RefusesAFileWithoutCycles) {
  auto writer = EventImageWriter::create(test_path("event_image_writer_none.npz"));
  ASSERT_TRUE(writer);
  EXPECT_EQ((*writer)->finish().error().code, ErrorCode::kInvalidValue);
}

TEST(EventImageWriter, WholeCyclesOfAnUnfinishedFileAreRead) {
  const fs::path folder = test_path("event_image_writer_unfinished");
  fs::remove_all(folder);
  auto writer = EventImageWriter::create(folder / "a.npz");
  ASSERT_TRUE(writer);
  (*writer)->keep(test_setup());
  for (uint64_t cycle = 0; cycle < 4; ++cycle) ASSERT_TRUE((*writer)->add(random_images(cycle)));
  const auto bytes = read_file(fs::directory_iterator(folder)->path()).value();
  for (const size_t cut : {size_t{0}, size_t{100}, bytes.size() / 2}) {
    const fs::path path = folder / "cut.npz";
    ASSERT_TRUE(write_file(path, std::span(bytes).first(bytes.size() - cut)));
    const auto file = read_event_images(path);
    ASSERT_TRUE(file) << file.error().text();
    EXPECT_EQ(file->setup.codes, test_setup().codes);
    EXPECT_TRUE(file->cycles.size() == (cut == 0 ? 4U : 3U) || cut > 100) << file->cycles.size();
    for (size_t i = 0; i < file->cycles.size(); ++i) EXPECT_EQ(file->cycles[i], random_images(i)) << cut;
  }
  ASSERT_TRUE(write_file(folder / "cut.npz", std::span(bytes).first(bytes.size() / 20)));
  EXPECT_FALSE(read_event_images(folder / "cut.npz"));
}

}  // namespace
}  // namespace e2lf::capture
