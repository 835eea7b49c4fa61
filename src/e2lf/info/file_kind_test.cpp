// SPDX-License-Identifier: MIT
#include "e2lf/info/file_kind.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/recordings/live/camera.h"
#include "testing/test_files.h"
#include "testing/test_light_field.h"

namespace e2lf::info {
namespace {

using testing::HasSubstr;

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

void write_array(const std::filesystem::path& path, std::vector<size_t> shape) {
  size_t size = 1;
  for (const size_t extent : shape) size *= extent;
  ASSERT_TRUE(write_npy(path, make_npy<int16_t>(std::move(shape), std::vector<int16_t>(size, 1))));
}

TEST(FileKind, TellsFilesByTheirContent) {
  const TestFolder folder;
  write_text(folder / "events.csv", "t,x,y,p\n1,2,3,1\n");
  write_array(folder / "list.npy", {5, 4});
  write_array(folder / "patterns.npy", {4, 8, 8});
  write_array(folder / "images.npy", {3, 20, 30});
  write_text(folder / "codes.json", R"({"patterns": []})");
  write_text(folder / "settings.bias", "300 % bias_diff\n");
  ASSERT_TRUE(capture::write_event_images(folder / "cycle.npz", {{capture::EventImages(3, 20, 30)}, {}}));
  EXPECT_EQ(file_kind(folder / "events.csv").value(), FileKind::kRecording);
  EXPECT_EQ(file_kind(folder / "list.npy").value(), FileKind::kRecording);
  EXPECT_EQ(file_kind(folder / "patterns.npy").value(), FileKind::kSettings);
  EXPECT_EQ(file_kind(folder / "images.npy").value(), FileKind::kEventImages);
  EXPECT_EQ(file_kind(folder / "codes.json").value(), FileKind::kSettings);
  EXPECT_EQ(file_kind(folder / "settings.bias").value(), FileKind::kSettings);
  EXPECT_EQ(file_kind(folder / "cycle.npz").value(), FileKind::kEventImages);
}

TEST(FileKind, TakesTextWithTheNameOfAnArrayForARecording) {
  const TestFolder folder;
  write_text(folder / "events.npy", "t,x,y,p\n1,2,3,1\n");
  EXPECT_EQ(file_kind(folder / "events.npy").value(), FileKind::kRecording);
}

TEST(FileKind, TellsFoldersByTheirContent) {
  const TestFolder folder;
  const auto field = lightfield::numbered_light_field({8, 8, 16, 16, 1});
  for (const char* name : {"scene", "cycles/cycle_00000", "cycles/cycle_00001"}) {
    std::filesystem::create_directories(folder / name);
    ASSERT_TRUE(lightfield::write_views(folder / name, field, lightfield::LightFieldFormat::kPng8));
  }
  write_array(folder / "recording.npy", {1, 4});
  std::filesystem::create_directories(folder / "images");
  write_array(folder / "images/event_image_00000.npy", {20, 30});
  write_text(folder / "run/config.json", "{}");
  write_text(folder / "run/log.csv", "step\n");
  EXPECT_EQ(file_kind(folder / "scene").value(), FileKind::kLightField);
  EXPECT_EQ(file_kind(folder / "cycles").value(), FileKind::kCycles);
  EXPECT_EQ(file_kind(folder / "images").value(), FileKind::kEventImages);
  EXPECT_EQ(file_kind(folder / "run").value(), FileKind::kTrainingRun);
}

TEST(FileKind, TakesLiveSourcesForRecordings) {
  recordings::add_camera_plugin({"any", "a camera that is not opened"});
  EXPECT_EQ(file_kind("-").value(), FileKind::kRecording);
  EXPECT_EQ(file_kind("camera://any").value(), FileKind::kRecording);
  EXPECT_EQ(file_kind("replay:no_such_file.raw").value(), FileKind::kRecording);
}

TEST(FileKind, SaysWhatAFolderContainsThatIsOfNoKind) {
  const TestFolder folder;
  write_text(folder / "notes/a.txt", "a");
  write_text(folder / "notes/b.txt", "b");
  const auto kind = file_kind(folder / "notes");
  ASSERT_FALSE(kind);
  EXPECT_EQ(kind.error().code, ErrorCode::kFormat);
  EXPECT_THAT(kind.error().message, HasSubstr("a.txt"));
  EXPECT_EQ(file_kind(folder / "missing").error().code, ErrorCode::kNotFound);
}

TEST(FileKind, NamesTheVerbForAnInputOfAnotherKind) {
  const Error error = other_kind_error("scene", FileKind::kLightField, "event images");
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_EQ(error.message, "expected event images, not a light field: `e2lf simulate` generates events from it");
}

}  // namespace
}  // namespace e2lf::info
