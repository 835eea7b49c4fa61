// SPDX-License-Identifier: MIT
#include "e2lf/compare/jobs.h"

#include <csignal>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/test_files.h"

namespace e2lf::compare {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two small rendered scenes with two seeds each, measured by the inversion.
Plan four_jobs() {
  Plan plan;
  plan.methods.resize(1);
  plan.methods[0].config.algorithm = "inversion";
  plan.methods[0].codes = capture::default_codes();
  plan.sensors.resize(1);
  for (const uint64_t scene : {0, 1}) {
    ComparedScene& rendered = plan.scenes.emplace_back();
    rendered.rendered_seed = scene;
    rendered.identity = scene;
    rendered.group.width = 48;
    rendered.group.height = 32;
    for (const uint64_t seed : {7, 8}) plan.jobs.push_back({0, scene, 0, seed, {scene, seed}, cat("s", scene, seed)});
  }
  return plan;
}

TEST(Jobs, OnlyMissingResultsOfTheShardAreOpen) {
  const TestFolder folder;
  const Plan plan = four_jobs();
  const ResultStore store(folder.path());
  EXPECT_THAT(open_jobs(plan, store, {}, false), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(open_jobs(plan, store, {2, 2}, false), ElementsAre(1, 3));
  ASSERT_TRUE(store.keep(plan, plan.jobs[1], Json::object(), {}));
  EXPECT_THAT(open_jobs(plan, store, {}, false), ElementsAre(0, 2, 3));
  EXPECT_THAT(open_jobs(plan, store, {2, 2}, true), ElementsAre(1, 3));
}

TEST(Jobs, OfEqualResultsOneIsOpen) {
  const TestFolder folder;
  Plan plan = four_jobs();
  plan.jobs[2].key = plan.jobs[0].key;
  EXPECT_THAT(open_jobs(plan, ResultStore(folder.path()), {}, false), ElementsAre(0, 1, 3));
}

TEST(Jobs, EachResultIsStoredAndThoseOfTheFirstSeedHavePictures) {
  const TestFolder folder;
  const Plan plan = four_jobs();
  const ResultStore store(folder.path());
  size_t last = 0, whole = 0;
  const auto progress = [&](size_t part, size_t total) {
    EXPECT_GE(part, last);
    last = part;
    whole = total;
  };
  EXPECT_EQ(run_jobs(plan, {0, 1, 3}, store, progress).value(), 3U);
  EXPECT_THAT(open_jobs(plan, store, {}, false), ElementsAre(2));
  EXPECT_GT(store.find(plan.jobs[0])->value("psnr_db", 0.0), 10.0);
  EXPECT_FALSE(store.picture(plan.jobs[0].key).empty());
  EXPECT_TRUE(store.picture(plan.jobs[1].key).empty());
  EXPECT_FALSE(store.picture(truth_key(plan.scenes[0])).empty());
  EXPECT_FALSE(store.picture(truth_key(plan.scenes[1])).empty()) << "the truth of a scene is drawn for any seed";
  EXPECT_LE(last, whole);
}

TEST(Jobs, AStopRequestEndsBeforeTheNextJob) {
  const TestFolder folder;
  const Plan plan = four_jobs();
  const ResultStore store(folder.path());
  request_stop(SIGTERM);
  const auto done = run_jobs(plan, {0, 1, 2}, store);
  request_stop(0);
  EXPECT_EQ(done.value(), 0U);
  EXPECT_THAT(open_jobs(plan, store, {}, false), ElementsAre(0, 1, 2, 3));
}

TEST(Jobs, WithoutPicturesOnlyFiguresAreStored) {
  const TestFolder folder;
  Plan plan = four_jobs();
  plan.pictures = false;
  const ResultStore store(folder.path());
  EXPECT_EQ(run_jobs(plan, {0}, store).value(), 1U);
  EXPECT_THAT(store.picture(plan.jobs[0].key), IsEmpty());
  EXPECT_THAT(store.picture(truth_key(plan.scenes[0])), IsEmpty());
}

}  // namespace
}  // namespace e2lf::compare
