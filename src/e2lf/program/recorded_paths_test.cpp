// SPDX-License-Identifier: MIT
#include <fstream>
#include <gtest/gtest.h>

#include "e2lf/program/option_values.h"
#include "e2lf/program/verb.h"
#include "testing/test_files.h"

namespace e2lf::program {
namespace {

struct RecordedRun {
  CLI::App app;
  std::filesystem::path input, output;
  std::string word;
  Json record;

  explicit RecordedRun(const std::filesystem::path& folder) {
    app.add_option("--input", input);
    app.add_option("--output", output);
    app.add_option("--word", word);
    record = {{"folder", folder.string()},
              {"inputs", {{{"path", "events.raw"}}}},
              {"options", {{"input", "events.raw"}, {"output", "out"}, {"word", "events"}}}};
  }
};

TEST(FindRecordedPaths, ResolvesPathsAgainstTheFolderOfTheRun) {
  const TestFolder folder;
  std::ofstream(folder / "events.raw") << "x";
  RecordedRun run(folder.path());
  EXPECT_TRUE(find_recorded_paths(run.record, run.app).empty());
  EXPECT_EQ(run.record["options"]["input"], (folder / "events.raw").string());
  EXPECT_EQ(run.record["options"]["output"], (folder / "out").string());
  EXPECT_EQ(run.record["options"]["word"], "events") << "not a path";
  EXPECT_EQ(run.record["inputs"][0]["path"], (folder / "events.raw").string());
}

TEST(FindRecordedPaths, ReturnsInputsThatNoLongerExist) {
  const TestFolder folder;
  RecordedRun run(folder.path());
  const auto missing = find_recorded_paths(run.record, run.app);
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].flag, "--input");
  EXPECT_EQ(missing[0].error.code, ErrorCode::kNotFound);
}

TEST(FindRecordedPaths, KeepsWhatFollowsTheNameOfAReplayedFile) {
  const TestFolder folder;
  std::ofstream(folder / "events.raw") << "x";
  RecordedRun run(folder.path());
  run.record["inputs"][0]["path"] = run.record["options"]["input"] = "replay:events.raw?speed=2";
  EXPECT_TRUE(find_recorded_paths(run.record, run.app).empty());
  EXPECT_EQ(run.record["options"]["input"], "replay:" + (folder / "events.raw").string() + "?speed=2");
}

}  // namespace
}  // namespace e2lf::program
