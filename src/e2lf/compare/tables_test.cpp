// SPDX-License-Identifier: MIT
#include "e2lf/compare/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::compare {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two methods, groups of two scenes and of one, one sensor, two seeds.
Plan small_plan() {
  Plan plan;
  plan.name = "a <plan>";
  plan.metrics = {"psnr_db", "ssim", "events_per_pixel", "reconstruct_s"};
  plan.methods.resize(2);
  plan.methods[0].config.name = "one";
  plan.methods[1].config.name = "two & more";
  for (ComparedMethod& method : plan.methods) method.codes = capture::default_codes();
  plan.groups = {"A", "B"};
  for (const char* name : {"a1", "a2", "b1"}) {
    Scene scene;
    scene.name = name;
    scene.group.name = name[0] == 'a' ? "A" : "B";
    plan.scenes.push_back(scene);
  }
  plan.sensors.resize(1);
  plan.sensors[0].config.name = "paper";
  for (size_t scene = 0; scene < 3; ++scene) {
    for (size_t method = 0; method < 2; ++method) {
      for (const uint64_t seed : {1, 2}) plan.jobs.push_back({method, scene, 0, seed, {}, {}});
    }
  }
  return plan;
}

/// PSNR 10 (scene + 1) + seed + 100 for the second method.
Results results_of(const Plan& plan) {
  Results results;
  for (const Job& job : plan.jobs) {
    const double psnr =
        10.0 * static_cast<double>(job.scene + 1) + static_cast<double>(job.seed) + (job.method == 1 ? 100.0 : 0.0);
    results.emplace_back(Json{
        {"psnr_db", psnr},
        {"ssim", 0.5},
        {"events_per_pixel", 7.0},
        {"reconstruct_s", 0.25},
        {"views_psnr_db", {psnr, psnr, psnr, psnr}},
    });
  }
  return results;
}

TEST(Tables, MeansAreOverSeedsThenScenesThenGroups) {
  const Plan plan = small_plan();
  const Results results = results_of(plan);
  EXPECT_EQ(scene_mean(plan, results, plan.jobs[0], "psnr_db"), 11.5);
  EXPECT_EQ(group_mean(plan, results, 0, 0, "A", "psnr_db"), 16.5);
  EXPECT_EQ(group_mean(plan, results, 0, 0, "B", "psnr_db"), 31.5);
  EXPECT_EQ(mean_of_groups(plan, results, 0, 0, "psnr_db"), 24.0);
}

TEST(Tables, AMissingResultLeavesItsMeansEmpty) {
  const Plan plan = small_plan();
  Results results = results_of(plan);
  results[1].reset();
  EXPECT_FALSE(scene_mean(plan, results, plan.jobs[0], "psnr_db"));
  EXPECT_FALSE(group_mean(plan, results, 0, 0, "A", "psnr_db"));
  EXPECT_FALSE(mean_of_groups(plan, results, 0, 0, "psnr_db"));
  EXPECT_EQ(group_mean(plan, results, 0, 0, "B", "psnr_db"), 31.5);
  const report::Table table = quality_table(plan, results, 0);
  EXPECT_EQ(table.rows[0][2].text, "");
  EXPECT_EQ(table.rows[0][3].text, "31.50/0.5000");
}

TEST(Tables, QualityIsMethodsByGroupsAsInThePaper) {
  const Plan plan = small_plan();
  const report::Table table = quality_table(plan, results_of(plan), 0);
  ASSERT_EQ(table.columns.size(), 5U);
  EXPECT_EQ(table.columns[4].name, "mean");
  EXPECT_EQ(table.rows[0][1].text, "4");
  EXPECT_EQ(table.rows[0][4].text, "24.00/0.5000");
  EXPECT_FALSE(table.rows[0][4].is_best);
  EXPECT_TRUE(table.rows[1][4].is_best);
  EXPECT_THAT(table.caption, HasSubstr("PSNR"));
}

TEST(Tables, SayWhichMethodsAreNotThere) {
  Plan plan = small_plan();
  plan.left_out = {"CA + E2VID"};
  const report::Table table = quality_table(plan, results_of(plan), 0);
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[2][0].text, "CA + E2VID (weights not available)");
  EXPECT_EQ(table.rows[2][4].text, "");
}

TEST(Tables, TheResultsHaveWhatIsTheSameInEveryRunAlone) {
  const Plan plan = small_plan();
  const std::string csv = report::table_csv(result_table(plan, results_of(plan)));
  EXPECT_TRUE(
      csv.starts_with("method,N,sensor,group,scene,seed,psnr_db,ssim,events_per_pixel\r\n"
                      "one,4,paper,A,a1,1,11.0,0.5,7.0\r\n"))
      << csv;
  const report::Table costs = cost_table(plan, results_of(plan), 0);
  EXPECT_EQ(costs.columns.back().name, "reconstruction s");
  EXPECT_EQ(costs.rows[0].back().text, "0.25");
}

TEST(ResultPage, HoldsTablesAndNoLink) {
  const Plan plan = small_plan();
  const std::string html = result_page(plan, results_of(plan), ResultStore("nowhere"), "e2lf compare 'c'");
  EXPECT_THAT(html, HasSubstr("a &lt;plan&gt;"));
  EXPECT_THAT(html, HasSubstr("two &amp; more"));
  EXPECT_THAT(html, HasSubstr("24.00/0.5000"));
  EXPECT_THAT(html, HasSubstr("12 of 12 results exist"));
  EXPECT_THAT(html, Not(HasSubstr("href")));
}

}  // namespace
}  // namespace e2lf::compare
