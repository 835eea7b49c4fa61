// SPDX-License-Identifier: MIT
#include "e2lf/files/file.h"

#include <csignal>
#include <future>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Workspace, IsLeftOutOfTextForPeople) {
  const std::string own = "." + std::to_string(::getpid()) + ".3.part";
  EXPECT_EQ(without_workspaces("/a/b c.csv" + own + "/b c.csv: cannot write"), "/a/b c.csv: cannot write");
  EXPECT_EQ(without_workspaces("/a/out" + own + "/out/00_00.png"), "/a/out/00_00.png");
  EXPECT_EQ(without_workspaces("/a/x.csv" + own + ": cannot write"), "/a/x.csv: cannot write");
  EXPECT_EQ(without_workspaces("x.csv.0.3.part: removed"), "x.csv.0.3.part: removed");
}

TEST(File, RoundTripsBytesAndLeavesNothingElse) {
  const TestFolder folder;
  std::vector<uint8_t> bytes(3'000'001);
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(i * 7);
  ASSERT_TRUE(write_file(folder / "a/b/c.bin", bytes).ok());
  const auto read = read_file(folder / "a/b/c.bin");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, bytes);
  EXPECT_EQ(count_entries(folder / "a/b"), 1U);
}

TEST(File, ReadsEmptyFilesAndFilesWithoutASize) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "empty", std::string()).ok());
  EXPECT_TRUE(read_file(folder / "empty")->empty());
  EXPECT_FALSE(read_file("/proc/self/status")->empty());
}

TEST(File, ReplacesAnExistingFile) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a", std::string("long old text")).ok());
  ASSERT_TRUE(write_file(folder / "a", std::string("new")).ok());
  EXPECT_EQ(text_of(folder / "a"), "new");
}

TEST(File, ReadingNamesTheFileThatIsMissingOrAFolder) {
  const TestFolder folder;
  const Error missing = read_file(folder / "none").error();
  EXPECT_EQ(missing.code, ErrorCode::kNotFound);
  EXPECT_EQ(missing.location, (folder / "none").string());
  EXPECT_EQ(read_file(folder.path()).error().code, ErrorCode::kIo);
}

TEST(File, WritingBelowAFileFailsAndLeavesTheFile) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a", std::string("kept")).ok());
  EXPECT_EQ(write_file(folder / "a/b", std::string("x")).error().code, ErrorCode::kIo);
  EXPECT_EQ(text_of(folder / "a"), "kept");
  // A folder cannot be replaced by a file either, and the part that was written is removed.
  fs::create_directories(folder / "d/sub");
  EXPECT_EQ(write_file(folder / "d", std::string("x")).error().code, ErrorCode::kIo);
  EXPECT_EQ(count_entries(folder.path()), 2U);
}

TEST(File, CheckOutputAsksForOverwrite) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a", std::string("x")).ok());
  const Error error = check_output(folder / "a", /*overwrite=*/false).error();
  EXPECT_EQ(error.code, ErrorCode::kExists);
  EXPECT_EQ(error.option, "overwrite");
  EXPECT_TRUE(check_output(folder / "a", /*overwrite=*/true).ok());
  EXPECT_TRUE(check_output(folder / "b", /*overwrite=*/false).ok());
}

TEST(File, ADeviceIsWrittenToAndNotReplaced) {
  ASSERT_TRUE(write_file("/dev/null", std::string("x")).ok());
  EXPECT_TRUE(is_stream("/dev/null"));
  EXPECT_EQ(write_file("/dev/full", std::string("x")).error().code, ErrorCode::kIo);
  EXPECT_EQ(AtomicFile::create("/dev/null").error().code, ErrorCode::kUnsupported);
}

TEST(File, AStopThatCameBeforeANamedPipeIsOpenedIsSeen) {
  const TestFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  request_stop(SIGTERM);
  const Result<int> stopped = open_stream(folder / "pipe");
  request_stop(0);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST(File, ANamedPipeHasMoreThanItsBufferHoldsWrittenOnceSomebodyReads) {
  const TestFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::vector<uint8_t> bytes(1'000'000, 7);
  auto written = std::async(std::launch::async, [&] { return write_file(folder / "pipe", bytes).ok(); });
  EXPECT_EQ(read_file(folder / "pipe").value(), bytes);
  EXPECT_TRUE(written.get());
}

}  // namespace
}  // namespace e2lf
