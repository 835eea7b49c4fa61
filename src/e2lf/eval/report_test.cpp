// SPDX-License-Identifier: MIT
#include "e2lf/eval/report.h"

#include <gtest/gtest.h>
#include <limits>

namespace e2lf::eval {
namespace {

EvalRow lego_row() {
  EvalRow row{"BF+RA", "lego, small", {}, {}};
  row.quality.mean = {28.404, 0.83321, 0.8512};
  row.quality.epi = {0.0123, 0.456};
  row.quality.views = {{0, 0, {28, 0.8, 0.81}}, {0, 1, {29, 0.9, 0.91}}, {1, 0, {30, 0.7, 0.71}}};
  return row;
}

TEST(ReportJson, HoldsTheMeansAndEachView) {
  const Json json = to_json(lego_row().quality);
  EXPECT_DOUBLE_EQ(json["psnr_db"].get<double>(), 28.404);
  EXPECT_DOUBLE_EQ(json["ssim_uniform7"].get<double>(), 0.83321);
  EXPECT_DOUBLE_EQ(json["ssim_gaussian"].get<double>(), 0.8512);
  EXPECT_DOUBLE_EQ(json["epi_relative_error"].get<double>(), 0.456);
  ASSERT_EQ(json["views"].size(), 3U);
  EXPECT_EQ(json["views"][2].dump(),
            R"({"view_y":1,"view_x":0,"psnr_db":30.0,"ssim_uniform7":0.7,"ssim_gaussian":0.71})");
}

TEST(ReportJson, WritesAnInfinitePsnrAsNull) {
  LightFieldMetrics equal;
  equal.mean = {std::numeric_limits<double>::infinity(), 1, 1};
  EXPECT_TRUE(to_json(equal)["psnr_db"].is_null());
}

TEST(ReportJson, AddsEventsOnlyWhereTheyAreKnown) {
  EvalRow row = lego_row();
  EXPECT_FALSE(to_json(row).contains("events"));
  row.events = event_cost(7.175);
  EXPECT_DOUBLE_EQ(to_json(row)["events"]["total_events_per_pixel"].get<double>(), 7.175);
  EXPECT_EQ(to_json(row)["scene"], "lego, small");
}

TEST(ReportJson, AddsTheDisparityOnlyWhereItIsKnown) {
  EvalRow row = lego_row();
  EXPECT_FALSE(to_json(row).contains("disparity"));
  EXPECT_EQ(quality_table({&row, 1}).columns.size(), 6U);
  row.disparity = depth::DisparityError{38.3, 21.5, 0.462, 0.36, 100, {{50, 10, 0.1}}};
  const Json json = to_json(row)["disparity"];
  EXPECT_DOUBLE_EQ(json["slope"].get<double>(), 0.36);
  EXPECT_DOUBLE_EQ(json["most_certain"][0]["bad_20_percent"].get<double>(), 10);
  EXPECT_EQ(quality_table({&row, 1}).rows[0][9].text, "0.36");
}

TEST(QualityTable, HasALineForEachRow) {
  EvalRow other{"Baseline", "cotton", {}, {}};
  other.quality.mean = {7.5, 0.1, 0.2};
  const std::vector<EvalRow> rows{lego_row(), other};
  EXPECT_EQ(report::table_text(quality_table(rows)),
            "method    scene        PSNR dB  SSIM 7x7  SSIM Gauss  EPI error\n"
            "BF+RA     lego, small    28.40    0.8332      0.8512      0.456\n"
            "Baseline  cotton          7.50    0.1000      0.2000      0.000\n");
}

TEST(QualityTable, ShowsEventsWhenAnyRowHasThem) {
  std::vector<EvalRow> rows{lego_row(), lego_row()};
  rows[1].events = event_cost(7.175);
  EXPECT_EQ(report::table_text(quality_table(rows)),
            "method  scene        PSNR dB  SSIM 7x7  SSIM Gauss  EPI error  events/px  min ms  bits/LF px\n"
            "BF+RA   lego, small    28.40    0.8332      0.8512      0.456          -       -           -\n"
            "BF+RA   lego, small    28.40    0.8332      0.8512      0.456      7.175    6.20        3.25\n");
}

TEST(QualityTable, SaysThatEqualPicturesHaveNoPsnr) {
  EvalRow row = lego_row();
  row.quality.mean.psnr_db = std::numeric_limits<double>::infinity();
  const report::Table table = quality_table({&row, 1});
  EXPECT_EQ(table.rows[0][2].text, "inf");
  EXPECT_TRUE(table.rows[0][2].value.is_null());
}

TEST(ReportViewGrid, PutsEachRowOfViewsOnALine) {
  EXPECT_EQ(view_grid_text(lego_row().quality), "28.00 29.00\n30.00\n");
}

TEST(QualityTable, HasTheNamesAndValuesOfTheJsonAsCsv) {
  const std::vector<EvalRow> rows{lego_row()};
  EXPECT_EQ(report::table_csv(quality_table(rows)),
            "method,scene,psnr_db,ssim_uniform7,ssim_gaussian,epi_relative_error\r\n"
            "BF+RA,\"lego, small\",28.404,0.83321,0.8512,0.456\r\n");
}

}  // namespace
}  // namespace e2lf::eval
