// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <string_view>

#include "e2lf/files/file.h"
#include "e2lf/recordings/recording.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

using namespace std::string_view_literals;

TEST(ForeignFile, IsNamedByItsFirstBytesAndNotByItsName) {
  constexpr std::pair<std::string_view, const char*> kFiles[] = {
      {"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x05\0\0\0a.raw"sv, "zip"},
      {"BZh91AY&SY"sv, "bzip2"},
      {"\xFD\x37zXZ\0\0\x04"sv, "xz"},
      {"7z\xBC\xAF\x27\x1C\0\x04"sv, "7-Zip"},
      {"#ROSBAG V2.0\n"sv, "ROS 1"},
      {"Event Stream\x02\0\0\x01"sv, "Event Stream"},
      {"#!AER-DAT2.0\r\n"sv, "aedat2_to_csv.py"},
      {"\x89PNG\r\n\x1A\n"sv, "PNG"},
  };
  TestFolder folder;
  for (const auto& [bytes, word] : kFiles) {
    std::vector<uint8_t> padded(bytes.begin(), bytes.end());
    padded.resize(600);
    ASSERT_TRUE(write_file(folder / "a.raw", padded).ok());
    const auto reader = open_recording(folder / "a.raw");
    ASSERT_FALSE(reader.ok()) << word;
    EXPECT_EQ(reader.error().code, ErrorCode::kUnsupported) << word;
    EXPECT_NE(reader.error().message.find(word), std::string::npos) << reader.error().message;
    EXPECT_NE(reader.error().message.find(';'), std::string::npos) << reader.error().message;
  }
}

}  // namespace
}  // namespace e2lf::recordings
