// SPDX-License-Identifier: MIT
#include "e2lf/files/result_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "testing/test_files.h"

namespace e2lf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder of ours with the named files, each with its own name as text.
void make_ours(const fs::path& target, const std::vector<std::string>& names) {
  auto output = ResultFolder::create(target, /*overwrite=*/true);
  ASSERT_TRUE(output.ok()) << output.error().text();
  for (const std::string& name : names) ASSERT_TRUE(write_file(output->path() / name, name).ok());
  const auto done = output->commit();
  ASSERT_TRUE(done.ok()) << done.error().text();
}

TEST(ResultFolder, AppearsOnlyWhenCommitted) {
  const TestFolder folder;
  auto output = ResultFolder::create(folder / "out/views", /*overwrite=*/false);
  ASSERT_TRUE(output.ok());
  ASSERT_TRUE(write_file(output->path() / "a", std::string("x")).ok());
  EXPECT_FALSE(fs::exists(folder / "out/views"));
  ASSERT_TRUE(output->commit().ok());
  EXPECT_EQ(text_of(folder / "out/views/a"), "x");
  EXPECT_TRUE(is_our_record(folder / "out/views/run.json"));
}

TEST(ResultFolder, RemovesEverythingWithoutCommit) {
  const TestFolder folder;
  {
    auto output = ResultFolder::create(folder / "out", /*overwrite=*/false);
    ASSERT_TRUE(write_file(output->path() / "a", std::string("x")).ok());
    const ResultFolder moved = *std::move(output);
    EXPECT_TRUE(fs::exists(moved.path()));
  }
  EXPECT_EQ(count_entries(folder.path()), 0U);
}

TEST(ResultFolder, ReplacesItsOwnFilesOnlyWhenAsked) {
  const TestFolder folder;
  make_ours(folder / "out", {"old", "sub/old"});
  EXPECT_EQ(ResultFolder::create(folder / "out", /*overwrite=*/false).error().code, ErrorCode::kExists);
  make_ours(folder / "out", {"new"});
  EXPECT_FALSE(fs::exists(folder / "out/old"));
  EXPECT_FALSE(fs::exists(folder / "out/sub"));
  EXPECT_EQ(text_of(folder / "out/new"), "new");
  EXPECT_EQ(count_entries(folder.path()), 1U);
}

TEST(ResultFolder, NeverReplacesAFolderOfSomeoneElse) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "out/precious", std::string("x")).ok());
  const auto expect_refused = [&folder](const char* why) {
    const auto output = ResultFolder::create(folder / "out", /*overwrite=*/true);
    ASSERT_FALSE(output.ok()) << why;
    EXPECT_THAT(output.error().message, HasSubstr("e2lf did not write this folder")) << why;
    EXPECT_EQ(text_of(folder / "out/precious"), "x");
  };
  expect_refused("no run.json");
  ASSERT_TRUE(write_file(folder / "out/run.json", std::string("{\"name\": \"mine\"}")).ok());
  expect_refused("a run.json that is not ours");
  make_ours(folder / "ours", {"a"});
  fs::remove(folder / "out/run.json");
  fs::create_symlink(folder / "ours/run.json", folder / "out/run.json");
  expect_refused("a run.json that is a link to one of ours");
}

TEST(ResultFolder, IsNotReplacedIfItHoldsAFileOfSomeoneElse) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "elsewhere/deep", std::string("far")).ok());
  for (const char* name : {"notes", "sub/notes", "link"}) {
    make_ours(folder / "out", {"a", "sub/b"});
    if (std::string(name) == "link") {
      fs::create_symlink(folder / "elsewhere", folder / "out" / name);
    } else {
      ASSERT_TRUE(write_file(folder / "out" / name, std::string("mine")).ok());
    }
    const auto refused = ResultFolder::create(folder / "out", /*overwrite=*/true);
    ASSERT_FALSE(refused.ok()) << name;
    EXPECT_EQ(refused.error().code, ErrorCode::kExists);
    EXPECT_THAT(refused.error().message, HasSubstr(name));
    EXPECT_EQ(text_of(folder / "out/a"), "a");
    fs::remove(folder / "out" / name);
  }
  EXPECT_EQ(text_of(folder / "elsewhere/deep"), "far");
}

TEST(ResultFolder, IsNotReplacedIfAFileOfSomeoneElseAppearedMeanwhile) {
  const TestFolder folder;
  make_ours(folder / "out", {"a"});
  auto output = ResultFolder::create(folder / "out", /*overwrite=*/true);
  ASSERT_TRUE(write_file(output->path() / "b", std::string("ours")).ok());
  ASSERT_TRUE(write_file(folder / "out/b", std::string("mine")).ok());
  const auto done = output->commit();
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.error().code, ErrorCode::kExists);
  EXPECT_EQ(text_of(folder / "out/b"), "mine");
  EXPECT_EQ(text_of(folder / "out/a"), "a");
}

TEST(ResultFolder, AListThatLeadsOutOfTheFolderRemovesNothingThere) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "precious", std::string("x")).ok());
  make_ours(folder / "out", {"a"});
  const std::string list =
      cat(R"({"written_by": "e2lf", "files": ["../precious", ")", (folder / "precious").string(), R"(", "a"]})");
  ASSERT_TRUE(write_file(folder / "out/run.json", list).ok());
  make_ours(folder / "out", {"b"});
  EXPECT_EQ(text_of(folder / "precious"), "x");
  EXPECT_FALSE(fs::exists(folder / "out/a"));
}

TEST(ResultFolder, PartsAppearOneByOneAndAreReplacedWithTheWhole) {
  const TestFolder folder;
  {
    auto output = ResultFolder::create(folder / "out", /*overwrite=*/false);
    for (const char* name : {"p0", "p1"}) {
      const auto part = output->begin_part(name);
      ASSERT_TRUE(part.ok());
      ASSERT_TRUE(write_file(*part / "view", std::string(name)).ok());
      ASSERT_TRUE(output->commit_part(name, {{"number", name}}).ok());
      if (std::string(name) == "p0") {
        ASSERT_TRUE(output->commit({{"complete", false}}).ok());
      }
      EXPECT_EQ(text_of(folder / "out" / name / "view"), name);
    }
    // What is not committed does not stay.
    ASSERT_TRUE(write_file(*output->begin_part("p2") / "view", std::string("half")).ok());
    ASSERT_TRUE(output->update_record({{"complete", true}}).ok());
  }
  EXPECT_EQ(count_entries(folder / "out"), 3U);
  EXPECT_EQ(count_entries(folder.path()), 1U);
  make_ours(folder / "out", {"a"});
  EXPECT_EQ(count_entries(folder / "out"), 2U);
}

TEST(ResultFolder, TwoRunsDoNotWriteOneOutput) {
  const TestFolder folder;
  const auto first = ResultFolder::create(folder / "out", /*overwrite=*/true);
  const auto second = ResultFolder::create(folder / "out", /*overwrite=*/true);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("output"));
  EXPECT_TRUE(ResultFolder::create(folder / "other", /*overwrite=*/false).ok());
}

TEST(ResultFolder, ClearsAwayWhatAKilledProcessLeft) {
  const TestFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const auto output = ResultFolder::create(folder / "out", /*overwrite=*/false);
    ::_exit(output.ok() ? 0 : 1);  // without a destructor, as by a kill
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  ASSERT_EQ(count_entries(folder.path()), 1U);
  fs::create_directory(folder / "out.1.2.part");  // not ours: it has no lock
  make_ours(folder / "out", {"a"});
  EXPECT_EQ(count_entries(folder.path()), 2U);
  EXPECT_EQ(text_of(folder / "out/a"), "a");
}

TEST(ResultFolder, TakesANameWithATrailingSlash) {
  const TestFolder folder;
  {
    auto output = ResultFolder::create(folder.path() / "out/", /*overwrite=*/false);
    ASSERT_TRUE(output.ok()) << output.error().text();
    ASSERT_TRUE(write_file(output->path() / "a", std::string("x")).ok());
    ASSERT_TRUE(output->commit().ok());
  }
  EXPECT_EQ(text_of(folder / "out/a"), "x");
  EXPECT_EQ(count_entries(folder.path()), 1U);
}

}  // namespace
}  // namespace e2lf
