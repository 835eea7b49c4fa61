// SPDX-License-Identifier: MIT
#include "e2lf/compare/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "testing/test_files.h"

namespace e2lf::compare {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Returns the text of a file of write_tables().
std::string written(const Plan& plan, const Results& results, const char* file) {
  const TestFolder folder;
  EXPECT_TRUE(write_tables(folder.path(), plan, results, ResultStore("nowhere"), "e2lf compare 'c'"));
  const std::vector<uint8_t> bytes = read_file(folder / file).value();
  return {bytes.begin(), bytes.end()};
}

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
    ComparedScene scene;
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

/// The means of PSNR of the first method: of each group, and of all.
std::vector<Json> psnr_of_groups(const Plan& plan, const Results& results) {
  std::vector<Json> means;
  const report::Table table = quality_table(plan, results, 0);
  for (size_t column = 2; column < table.columns.size(); ++column) {
    const Json& value = table.rows[0][column].value;
    means.push_back(value.is_null() ? Json() : value["psnr_db"]);
  }
  return means;
}

TEST(Tables, MeansAreOverSeedsThenScenesThenGroups) {
  Plan plan = small_plan();
  const Results results = results_of(plan);
  EXPECT_THAT(psnr_of_groups(plan, results), ElementsAre(16.5, 31.5, 24.0));
  plan.scenes[1].group.name = "B";
  EXPECT_THAT(psnr_of_groups(plan, results), ElementsAre(11.5, 26.5, 19.0));
}

TEST(Tables, AMissingResultLeavesItsMeansEmpty) {
  const Plan plan = small_plan();
  Results results = results_of(plan);
  results[1].reset();
  EXPECT_THAT(psnr_of_groups(plan, results), ElementsAre(Json(), 31.5, Json()));
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
  const std::string csv = written(plan, results_of(plan), "table.csv");
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
  const std::string html = written(plan, results_of(plan), "index.html");
  EXPECT_THAT(html, HasSubstr("a &lt;plan&gt;"));
  EXPECT_THAT(html, HasSubstr("two &amp; more"));
  EXPECT_THAT(html, HasSubstr("24.00/0.5000"));
  EXPECT_THAT(html, HasSubstr("12 of 12 results exist"));
  EXPECT_THAT(html, Not(HasSubstr("href")));
}

}  // namespace
}  // namespace e2lf::compare
