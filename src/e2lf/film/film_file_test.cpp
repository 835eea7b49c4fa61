// SPDX-License-Identifier: MIT
#include "e2lf/film/film_file.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/files/file.h"

namespace e2lf::film {
namespace {

using lightfield::Image;

/// A ramp that moves.
Image frame(size_t number, size_t channels) {
  Image image(33, 20, channels);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<float>((i / channels % 33 + number) % 33) / 33;
  }
  return image;
}

Result<void> write(const std::filesystem::path& path, size_t frames, size_t channels) {
  E2LF_ASSIGN_OR_RETURN(const FilmFormat format, film_format_of(path));
  return write_film(path, format, {[channels](size_t i) { return frame(i, channels); }, frames, 10});
}

class FilmFile : public testing::Test {
 protected:
  void SetUp() override {
    if (!check_film_support()) GTEST_SKIP() << "this build writes no films";
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      (std::string("e2lf_film_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(FilmFile, GifHasTheSizeAndEveryFrame) {
  const auto path = folder_ / "a.gif";
  ASSERT_TRUE(write(path, 5, 1).ok());
  const std::vector<uint8_t> bytes = read_file(path).value();
  ASSERT_GT(bytes.size(), 10U);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 6), "GIF89a");
  EXPECT_EQ(bytes[6] + 256 * bytes[7], 33);
  EXPECT_EQ(bytes[8] + 256 * bytes[9], 20);
  // A graphic control extension of four bytes begins each frame; 10 centiseconds.
  size_t frames = 0;
  for (size_t i = 0; i + 7 < bytes.size(); ++i) {
    if (bytes[i] == 0x21 && bytes[i + 1] == 0xF9 && bytes[i + 2] == 4 && bytes[i + 4] == 10) ++frames;
  }
  EXPECT_EQ(frames, 5U);
  EXPECT_EQ(bytes.back(), 0x3B);
}

TEST_F(FilmFile, WebmAndMp4BeginAsTheyShould) {
  ASSERT_TRUE(write(folder_ / "a.webm", 5, 3).ok());
  const std::vector<uint8_t> webm = read_file(folder_ / "a.webm").value();
  const std::vector<uint8_t> ebml = {0x1A, 0x45, 0xDF, 0xA3};
  EXPECT_TRUE(std::equal(ebml.begin(), ebml.end(), webm.begin()));
  ASSERT_TRUE(write(folder_ / "a.mp4", 5, 1).ok());
  const std::vector<uint8_t> mp4 = read_file(folder_ / "a.mp4").value();
  EXPECT_EQ(std::string(mp4.begin() + 4, mp4.begin() + 8), "ftyp");
}

TEST_F(FilmFile, IsTheSameEachTime) {
  for (const char* name : {"a.gif", "a.mp4"}) {
    ASSERT_TRUE(write(folder_ / name, 3, 1).ok());
    const std::vector<uint8_t> first = read_file(folder_ / name).value();
    ASSERT_TRUE(write(folder_ / name, 3, 1).ok());
    EXPECT_EQ(read_file(folder_ / name).value(), first) << name;
  }
}

TEST_F(FilmFile, SaysWhereItCannotWrite) {
  const auto result = write(folder_ / "absent" / "a.gif", 1, 1);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kIo);
}

TEST(FilmFormat, IsWhatTheExtensionSays) {
  EXPECT_EQ(film_format_of("a.mp4").value(), FilmFormat::kMp4);
  EXPECT_EQ(film_format_of("a.avi").error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::film
