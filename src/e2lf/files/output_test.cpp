// SPDX-License-Identifier: MIT
#include "e2lf/files/output.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/test_files.h"

namespace e2lf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void put_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST(CheckApart, ComparesFilesInsteadOfNames) {
  const TestFolder folder;
  put_text(folder / "in/events.raw", "x");
  fs::create_directory_symlink(folder / "in", folder / "link");
  EXPECT_TRUE(check_apart(folder / "out", {folder / "in"}));
  for (const char* name : {"in", "in/events.raw", "link/events.raw", "in/deeper", "link/../in"}) {
    EXPECT_FALSE(check_apart(folder / name, {folder / "in"})) << name;
  }
  const auto contains = check_apart(folder.path(), {folder / "in/events.raw"});
  ASSERT_FALSE(contains);
  EXPECT_EQ(contains.error().code, ErrorCode::kInvalidValue);
}

TEST(OutputFile, AppearsWholeWithItsRecordOrNotAtAll) {
  const TestFolder folder;
  {
    auto output = OutputFile::create(folder / "a.csv", {}).value();
    put_text(output.path(), "t,x,y,p\n");
    EXPECT_FALSE(fs::exists(folder / "a.csv"));
  }
  EXPECT_EQ(count_entries(folder.path()), 0U) << "a run that fails leaves something";
  auto output = OutputFile::create(folder / "a.csv", {}).value();
  put_text(output.path(), "t,x,y,p\n");
  put_text(output.record_path(), "{}");
  ASSERT_TRUE(output.commit());
  EXPECT_EQ(text_of(folder / "a.csv"), "t,x,y,p\n");
  EXPECT_EQ(text_of(folder / "a.csv.run.json"), "{}");
}

TEST(OutputFile, IsReplacedOnlyIfAsked) {
  const TestFolder folder;
  put_text(folder / "a.csv", "old");
  const auto refused = OutputFile::create(folder / "a.csv", {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kExists);
  auto output = OutputFile::create(folder / "a.csv", {.overwrite = true}).value();
  put_text(output.path(), "new");
  EXPECT_EQ(text_of(folder / "a.csv"), "old") << "before it is complete";
  ASSERT_TRUE(output.commit());
  EXPECT_EQ(text_of(folder / "a.csv"), "new");
}

TEST(OutputFile, KeepsTheOldResultWithItsRecordIfTheNewOneCannotBeMoved) {
  const TestFolder folder;
  put_text(folder / "a.csv", "old");
  put_text(folder / "a.csv.run.json", R"({"written_by": "e2lf"})");
  auto output = OutputFile::create(folder / "a.csv", {.overwrite = true}).value();
  EXPECT_FALSE(output.commit()) << "nothing was written";
  EXPECT_EQ(text_of(folder / "a.csv"), "old");
  EXPECT_TRUE(fs::exists(folder / "a.csv.run.json"));
}

TEST(OutputFile, RefusesNamesThatWouldBeReadAsSomethingElse) {
  const TestFolder folder;
  const auto code = [&](const char* name, OutputRules rules = {}) {
    const auto output = OutputFile::create(folder / name, rules);
    return output ? std::optional<ErrorCode>() : output.error().code;
  };
  put_text(folder / "a.csv", "t,x,y,p\n");
  put_text(folder / "a.csv.run.json", "{}");
  EXPECT_EQ(code("a.csv.run.json", {.overwrite = true}), ErrorCode::kExists) << "the record of a.csv";
  EXPECT_EQ(code("b.jpg", {.ending = ".png"}), ErrorCode::kInvalidValue);
  EXPECT_EQ(code("b.png", {.ending = ".png"}), std::nullopt);
  EXPECT_EQ(code("a.csv", {.inputs = {folder / "a.csv"}, .overwrite = true}), ErrorCode::kInvalidValue);
}

TEST(OutputFile, DoesNotFollowALinkToNothing) {
  const TestFolder folder;
  fs::create_symlink(folder / "missing", folder / "link.csv");
  const auto output = OutputFile::create(folder / "link.csv", {.overwrite = true});
  ASSERT_FALSE(output);
  EXPECT_THAT(output.error().message, HasSubstr("does not exist"));
}

TEST(OutputFile, StreamsOnlyFormatsThatAreWrittenFrontToBack) {
  EXPECT_TRUE(OutputFile::create("-", {.streams = true}).value().is_stream());
  const auto output = OutputFile::create("-", {});
  ASSERT_FALSE(output);
  EXPECT_EQ(output.error().code, ErrorCode::kUnsupported);
}

TEST(OpenResultFolder, RefusesTheNameOfAFileAndFoldersOfOthers) {
  const TestFolder folder;
  const OutputRules rules{.overwrite = true};
  EXPECT_TRUE(open_result_folder(folder / "frames", rules));
  EXPECT_FALSE(open_result_folder(folder / "frames.mp4", rules));
  put_text(folder / "notes/a.txt", "mine");
  const auto foreign = open_result_folder(folder / "notes", rules);
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::kExists);
}

}  // namespace
}  // namespace e2lf
