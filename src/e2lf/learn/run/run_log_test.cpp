// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/run_log.h"

#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

#include "testing/test_training_data.h"

namespace e2lf::learn {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(RunLog, RewindDropsWhatCameAfterACheckpoint) {
  const TestData data;
  const RunLog log(data.folder(), LogFigures::of_views());
  ASSERT_TRUE(log.rewind(5));  // nothing there yet
  for (const uint64_t step : {5U, 10U, 15U}) {
    ASSERT_TRUE(log.add(StepRow{.step = step, .samples = 2 * step, .loss = 0.5}));
    ASSERT_TRUE(log.add(step, 2 * step, SceneScore{.name = "a", .score = 20, .events_per_pixel = 7}));
  }
  ASSERT_TRUE(log.rewind(10));
  EXPECT_EQ(content(data.folder() / "evaluation.csv"),
            "step,samples,scene,psnr_db,events_per_pixel\n5,10,a,20,7\n10,20,a,20,7\n");
  const auto steps = content(data.folder() / "log.csv");
  EXPECT_NE(steps.find("\n10,20,0.5,"), std::string::npos);
  EXPECT_EQ(steps.find("\n15,"), std::string::npos);
}

TEST(RunLog, DrawsAPageThatStandsAlone) {
  const TestData data;
  const RunLog log(data.folder(), LogFigures::of_views());
  for (const uint64_t step : {1U, 2U, 3U}) {
    ASSERT_TRUE(log.add(StepRow{.step = step, .samples = step, .figure = 0.1 / static_cast<double>(step)}));
    for (const char* scene : {"first", "second<"}) {
      ASSERT_TRUE(log.add(step, step, SceneScore{scene, 20.0 + static_cast<double>(step), 7}));
    }
    ASSERT_TRUE(log.add(step, step, std::vector<float>(4 * 64, 0.25F)));
  }
  ASSERT_TRUE(log.draw_curves("a run", {{"train", {{"batch", 4}}}}));
  const auto page = content(data.folder() / "curves.html");
  const auto count = [&](const std::string& part) {
    size_t found = 0;
    for (size_t at = page.find(part); at != std::string::npos; at = page.find(part, at + 1)) ++found;
    return found;
  };
  // Loss and its mean, two scenes' PSNR and events, learning rate, speed.
  EXPECT_EQ(count("<polyline"), 8U);
  EXPECT_EQ(count("stroke-width=\"0.4\"/>"), 3U * 4 * 64);
  EXPECT_EQ(count("<td class=\"\">second&lt;</td>"), 1U);
  EXPECT_EQ(count("<td class=\"\">train batch</td><td class=\"\">4</td>"), 1U);
  EXPECT_EQ(count("src="), 0U);
  EXPECT_EQ(count("nan"), 0U);
}

TEST(RunLog, NamesOfScenesMayContainCommas) {
  const TestData data;
  const RunLog log(data.folder(), LogFigures::of_views());
  ASSERT_TRUE(log.add(50, 200, SceneScore{"a, \"b\"", 21.25, 7}));
  ASSERT_TRUE(log.draw_curves("a run", Json::object()));
  const std::string page = content(data.folder() / "curves.html");
  EXPECT_NE(page.find("a, &quot;b&quot;"), std::string::npos);
  EXPECT_NE(page.find("21.25"), std::string::npos);
}

TEST(RunLog, BeforeAnEvaluationThePageSaysWhenItComes) {
  const TestData data;
  const RunLog log(data.folder(), LogFigures::of_views());
  const Json config = {{"train", {{"batch", 4}, {"steps", 700}, {"evaluate_steps", 50}}}};
  ASSERT_TRUE(log.draw_curves("a run", config));
  EXPECT_NE(content(data.folder() / "curves.html").find("after step 50, that is after 200 samples"), std::string::npos);
  ASSERT_TRUE(log.add(50, 200, SceneScore{"scene", 20.0, 7}));
  ASSERT_TRUE(log.draw_curves("a run", config));
  EXPECT_EQ(content(data.folder() / "curves.html").find("after step 50"), std::string::npos);
}

}  // namespace
}  // namespace e2lf::learn
