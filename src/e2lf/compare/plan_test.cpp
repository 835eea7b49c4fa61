// SPDX-License-Identifier: MIT
#include "e2lf/compare/plan.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "e2lf/compare/jobs.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/video/import_event_video.h"
#include "testing/event_video_checkpoints.h"

namespace e2lf::compare {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// A folder with scenes and a camera. Scenes are hashed by name: plans never read them.
class PlanTest : public testing::Test {
 protected:
  PlanTest() {
    for (const char* scene : {"a", "b", "c"}) fs::create_directories(folder_ / "set" / scene);
    std::ofstream(folder_ / "paper.json") << R"({"name": "paper", "event_model": "reference-aware", "constants": {
      "eps": {"value": 0.01}, "tau": {"value": 0.3}, "sigma_w": {"value": 0.175}, "sigma_z": {"value": 0.04}}})";
    environment_.locate = [this](const std::string& name) -> Result<fs::path> {
      if (fs::exists(folder_ / name)) return folder_ / name;
      return Error{ErrorCode::kNotFound, "it is not there; correct the name", name};
    };
    environment_.locate_camera = [this](const std::string&) -> Result<fs::path> { return folder_ / "paper.json"; };
    environment_.hash = [this](const fs::path& path) -> Result<std::string> {
      return path.filename().string() + salt_;
    };
    environment_.version = "1";
  }
  ~PlanTest() override { fs::remove_all(folder_); }

  static ComparisonConfig config() {
    ComparisonConfig config;
    config.methods.resize(1);
    config.methods[0].name = "inversion";
    config.methods[0].algorithm = "inversion";
    config.scenes.resize(1);
    config.scenes[0].name = "group";
    config.scenes[0].scenes = {"set/*"};
    return config;
  }

  std::set<std::string> keys_of(const ComparisonConfig& config) {
    std::set<std::string> keys;
    const auto plan = make_plan(config, environment_);
    EXPECT_TRUE(plan) << plan.error().text();
    for (const Job& job : plan->jobs) keys.insert(job.key);
    return keys;
  }

  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("e2lf_plan_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::string salt_;
  Environment environment_;
};

TEST_F(PlanTest, DependsOnTheModelsOfWhichAModelIsComposed) {
  ComparisonConfig any = config();
  any.methods[0].algorithm = "network";
  any.methods[0].model = "e2lf-any";
  any.methods[0].codes = "e2lf-n4";
  environment_.locate = [this](const std::string& name) -> Result<fs::path> {
    return bundled_file_named(kBundledModels, name).value_or(folder_ / name);
  };
  std::string changed;
  environment_.hash = [&](const fs::path& path) -> Result<std::string> {
    return path.stem().string() + (path.stem() == changed ? " (changed)" : "");
  };
  const std::set<std::string> keys = keys_of(any);
  EXPECT_EQ(keys_of(any), keys);
  changed = "e2lf-depth-first";
  EXPECT_NE(keys_of(any), keys);
  EXPECT_THAT(make_plan(any, environment_).value().files,
              testing::Contains(*bundled_file_named(kBundledModels, "e2lf-depth-first")));
}

TEST_F(PlanTest, ListsEveryJobOnceSceneByScene) {
  ComparisonConfig two = config();
  two.seeds = {1, 2};
  two.sensors.push_back(two.sensors[0]);
  two.sensors[1].name = "dim";
  two.sensors[1].gain = 0.5F;
  const auto plan = make_plan(two, environment_);
  ASSERT_TRUE(plan) << plan.error().text();
  EXPECT_THAT(plan->scenes,
              ElementsAre(testing::Field(&ComparedScene::name, "a"), testing::Field(&ComparedScene::name, "b"),
                          testing::Field(&ComparedScene::name, "c")));
  ASSERT_EQ(plan->jobs.size(), 3U * 2U * 2U);
  EXPECT_EQ(keys_of(two).size(), plan->jobs.size());
  EXPECT_EQ(plan->jobs[3].scene, 0U);
  EXPECT_EQ(plan->jobs[4].scene, 1U);
}

TEST_F(PlanTest, KeysDependOnContentAndNotOnNames) {
  const auto keys = keys_of(config());
  ComparisonConfig renamed = config();
  renamed.methods[0].name = "another name";
  renamed.scenes[0].name = "another group";
  renamed.sensors[0].name = "another sensor";
  EXPECT_EQ(keys_of(renamed), keys);
  salt_ = " changed";
  EXPECT_NE(keys_of(config()), keys);
}

TEST_F(PlanTest, EverySettingThatMattersChangesTheKeys) {
  std::vector<ComparisonConfig> changed(11, config());
  changed[0].methods[0].gain = 2;
  changed[1].methods[0].fit_gain = true;
  changed[2].sensors[0].tau = 0.2F;
  changed[3].sensors[0].gain = 0.5F;
  changed[4].sensors[0].cycles = 2;
  changed[5].sensors[0].residue = 1;
  changed[6].scenes[0].width = 8;
  changed[7].scenes[0].reverse_rows = true;
  changed[8].seeds = {2};
  changed[9].sensors[0].fit_gain = true;
  changed[10].sensors[0].sigma_i = 0.01F;
  std::set<std::string> all = keys_of(config());
  for (const ComparisonConfig& each : changed) {
    const size_t before = all.size();
    all.merge(keys_of(each));
    EXPECT_EQ(all.size(), before + 3) << "setting " << &each - changed.data();
  }
  environment_.version = "2";
  const size_t before = all.size();
  all.merge(keys_of(config()));
  EXPECT_EQ(all.size(), before + 3);
}

TEST_F(PlanTest, AMethodMoreKeepsTheKeysOfTheOthers) {
  const auto keys = keys_of(config());
  ComparisonConfig more = config();
  more.methods.insert(more.methods.begin(), more.methods[0]);
  more.methods[0].name = "fitted";
  more.methods[0].fit_gain = true;
  const auto all = keys_of(more);
  EXPECT_EQ(all.size(), 2 * keys.size());
  EXPECT_TRUE(std::includes(all.begin(), all.end(), keys.begin(), keys.end()));
}

TEST_F(PlanTest, OthersStandInForAGroupThatIsNotThere) {
  ComparisonConfig missing = config();
  missing.scenes.push_back(missing.scenes[0]);
  missing.scenes[1].name = "standing in";
  missing.scenes[1].scenes = {"none/*"};
  missing.scenes[1].stand_in = {"set/b", "set/none"};
  missing.scenes.push_back(missing.scenes[1]);
  missing.scenes[2].name = "left out";
  missing.scenes[2].stand_in = {"set/none"};
  EXPECT_EQ(make_plan(missing, environment_).error().location, "none");
  missing.scenes[2].optional = true;
  const auto plan = make_plan(missing, environment_);
  ASSERT_TRUE(plan) << plan.error().text();
  EXPECT_THAT(plan->groups, ElementsAre("group", "standing in"));
  ASSERT_EQ(plan->scenes.size(), 4U);
  EXPECT_EQ(plan->scenes[3].name, "b");
}

TEST_F(PlanTest, WhatIsNotOptionalMustBeThere) {
  ComparisonConfig missing = config();
  missing.scenes[0].scenes = {"set/a", "set/none"};
  EXPECT_EQ(make_plan(missing, environment_).error().location, "set/none");
  missing = config();
  missing.methods[0] = {.name = "net", .model = "none.safetensors"};
  EXPECT_EQ(make_plan(missing, environment_).error().location, "none.safetensors");
  missing.methods[0].optional = true;
  missing.methods.push_back(config().methods[0]);
  EXPECT_THAT(make_plan(missing, environment_).value().left_out, ElementsAre("net"));
  missing.methods.pop_back();
  EXPECT_THAT(make_plan(missing, environment_).error().message, HasSubstr("nothing"));
  missing = config();
  missing.scenes[0].scenes = {"demo:x"};
  EXPECT_THAT(make_plan(missing, environment_).error().message, HasSubstr("number"));
}

TEST_F(PlanTest, AScanDependsOnTheThresholdAndNoOtherConstant) {
  const fs::path checkpoint = folder_ / "checkpoint.safetensors";
  ASSERT_TRUE(write_safetensors(checkpoint, video::firenet_checkpoint(true)));
  ASSERT_TRUE(video::write_video_model(folder_ / "frames.safetensors", *video::import_event_video(checkpoint)));
  ComparisonConfig scan = config();
  scan.methods[0] = {.name = "scan", .algorithm = "event-video", .model = "frames.safetensors"};
  scan.sensors.resize(3);
  scan.sensors[1].sigma_w = 0.0F;
  scan.sensors[2].tau = 0.2F;
  const auto plan = make_plan(scan, environment_);
  ASSERT_TRUE(plan) << plan.error().text();
  ASSERT_EQ(plan->jobs.size(), 9U);
  EXPECT_EQ(plan->jobs[0].key, plan->jobs[1].key);
  EXPECT_NE(plan->jobs[0].key, plan->jobs[2].key);
  EXPECT_EQ(keys_of(scan).size(), 6U);
}

TEST_F(PlanTest, TheStoreFindsWhatWasMadeOfTheSameAlone) {
  const auto plan = make_plan(config(), environment_);
  ASSERT_TRUE(plan);
  const ResultStore store(folder_ / "out"), other(folder_ / "other");
  const Job& job = plan->jobs[1];
  EXPECT_FALSE(store.find(job));
  ASSERT_TRUE(store.keep(*plan, job, {{"psnr_db", 28.5}}, {1, 2, 3}));
  EXPECT_EQ(store.find(job)->at("psnr_db"), 28.5);
  EXPECT_THAT(store.picture(job.key), ElementsAre(1, 2, 3));
  EXPECT_FALSE(store.find(plan->jobs[0]));
  Job forged = plan->jobs[0];
  forged.key = job.key;
  EXPECT_FALSE(store.find(forged));
  EXPECT_EQ(other.take_over(*plan, store).value(), 1U);
  EXPECT_EQ(other.take_over(*plan, store).value(), 0U);
  EXPECT_EQ(other.find(job), store.find(job));
  EXPECT_THAT(other.picture(job.key), ElementsAre(1, 2, 3));
  ASSERT_TRUE(write_file(folder_ / "out" / "results" / (job.key + ".json"), std::string("{\"inputs\": 1}")));
  EXPECT_FALSE(store.find(job));
}

TEST_F(PlanTest, AResultThatWasChangedIsNoResult) {
  const auto plan = make_plan(config(), environment_);
  ASSERT_TRUE(plan);
  const ResultStore store(folder_ / "out");
  const Job& job = plan->jobs[0];
  const fs::path file = folder_ / "out" / "results" / (job.key + ".json");
  ASSERT_TRUE(store.keep(*plan, job, {{"psnr_db", 28.123456789012345}, {"views", {1.5, nullptr}}}, {}));
  ASSERT_TRUE(store.find(job));
  Json json = read_json(file).value();
  json["method"] = "another name";
  ASSERT_TRUE(write_file(file, json.dump()));
  EXPECT_TRUE(store.find(job));
  json["figures"]["psnr_db"] = 35.0;
  ASSERT_TRUE(write_file(file, json.dump()));
  EXPECT_FALSE(store.find(job));
}

}  // namespace
}  // namespace e2lf::compare
