// SPDX-License-Identifier: MIT
#include <fstream>
#include <gtest/gtest.h>

#include "e2lf/program/options.h"
#include "e2lf/program/verb.h"
#include "testing/test_files.h"

namespace e2lf::program {
namespace {

struct RecordedRun {
  CLI::App app;
  std::filesystem::path input, output, schedule;
  std::string word;
  Json record;

  explicit RecordedRun(const std::filesystem::path& folder) {
    app.add_option("--input", input);
    app.add_option("--output", output);
    app.add_option("--schedule", schedule)->check(CLI::ExistingFile);
    app.add_option("--word", word);
    record = {{"folder", folder.string()},
              {"inputs", {{{"path", "events.raw"}}}},
              {"options", {{"input", "events.raw"}, {"output", "out"}, {"schedule", "s.json"}, {"word", "events"}}}};
  }
};

TEST(RecordedPaths, ResolvesPathsAgainstTheFolderOfTheRun) {
  const TestFolder folder;
  std::ofstream(folder / "events.raw") << "x";
  RecordedRun run(folder.path());
  resolve_recorded_paths(run.record, run.app);
  EXPECT_EQ(run.record["options"]["input"], (folder / "events.raw").string());
  EXPECT_EQ(run.record["options"]["output"], (folder / "out").string());
  EXPECT_EQ(run.record["options"]["schedule"], (folder / "s.json").string()) << "whatever is checked of it";
  EXPECT_EQ(run.record["options"]["word"], "events") << "not a path";
  EXPECT_EQ(run.record["inputs"][0]["path"], (folder / "events.raw").string());
}

TEST(RecordedPaths, KeepsWhatFollowsTheNameOfAReplayedFile) {
  const TestFolder folder;
  std::ofstream(folder / "events.raw") << "x";
  RecordedRun run(folder.path());
  run.record["inputs"][0]["path"] = run.record["options"]["input"] = "replay:events.raw?speed=2";
  resolve_recorded_paths(run.record, run.app);
  EXPECT_EQ(run.record["options"]["input"], "replay:" + (folder / "events.raw").string() + "?speed=2");
}

TEST(RecordedPaths, TakesNoOtherFileForOneThatIsGone) {
  const TestFolder folder;
  RecordedRun run(folder.path());
  std::string camera, patterns;
  run.app.add_option("--camera", camera)->type_name(kCameraType);
  run.app.add_option("--codes", patterns)->type_name(kCodesType);
  run.record["options"]["camera"] = "gone/camera.json";
  run.record["options"]["codes"] = "e2lf-n4";
  resolve_recorded_paths(run.record, run.app);
  EXPECT_EQ(run.record["options"]["camera"], (folder / "gone/camera.json").string());
  EXPECT_EQ(run.record["options"]["codes"], "e2lf-n4") << "the name of a bundled file";
}

}  // namespace
}  // namespace e2lf::program
