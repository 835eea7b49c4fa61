// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/curves.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/report/axis.h"

namespace e2lf::learn {
namespace {

/// Computes the running mean over about a twentieth of the curve.
report::Line running_mean(const report::Line& line) {
  report::Line mean{"running mean", {}};
  const auto window = std::max<size_t>(1, line.points.size() / 20);
  double sum = 0;
  for (size_t i = 0; i < line.points.size(); ++i) {
    sum += line.points[i].y - (i >= window ? line.points[i - window].y : 0.0);
    mean.points.push_back({line.points[i].x, sum / static_cast<double>(std::min(i + 1, window))});
  }
  return mean;
}

void add_chart(const char* heading, std::vector<report::Line> lines, bool is_logarithmic, report::Page& page) {
  if (lines.empty() || lines.front().points.empty()) return;
  report::LineChart chart{"samples", heading, std::move(lines), is_logarithmic};
  page.drawing(report::chart_svg(chart));
}

/// Returns the text above the results of the validation; before there are any, it states when the first ones will come.
std::string scenes_caption(const RunCurves& curves, const Json& config) {
  const auto setting = [&](const char* key) { return config.value(Json::json_pointer(key), uint64_t{0}); };
  const uint64_t step = std::min(setting("/train/evaluate_steps"), setting("/train/steps"));
  if (!curves.psnr_db.empty() || step == 0) return "Validation scenes.";
  return cat("Validation scenes: the first evaluation comes after step ", step, ", that is after ",
             step * setting("/train/batch"), " samples.");
}

/// Adds a table of the last and the best results of each scene.
report::Table scene_table(const RunCurves& curves, const Json& config) {
  report::Table table{scenes_caption(curves, config),
                      {{"scene"},
                       {"PSNR dB", true, false, "psnr_db"},
                       {"best PSNR dB", true, false, "best_psnr_db"},
                       {"best after samples", true, false, "best_samples"},
                       {"events per pixel", true, false, "events_per_pixel"}},
                      {}};
  for (size_t i = 0; i < curves.psnr_db.size(); ++i) {
    const auto& points = curves.psnr_db[i].points;
    const auto best =
        std::max_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
    table.rows.push_back({report::text_cell(curves.psnr_db[i].name), report::number_cell(points.back().y, 2),
                          report::number_cell(best->y, 2), report::number_cell(best->x, 0),
                          report::number_cell(curves.events_per_pixel[i].points.back().y, 3)});
  }
  return table;
}

/// Adds the patterns of one point of the run side by side.
void add_patterns(const PatternState& state, report::Page& page) {
  constexpr size_t kSide = 8, kCells = kSide * kSide;
  page.heading(cat("After ", report::tick_text(state.samples, 0), " samples"), 4).begin_row();
  for (size_t begin = 0; begin + kCells <= state.cells.size(); begin += kCells) {
    const auto first = state.cells.begin() + static_cast<ptrdiff_t>(begin);
    report::CellGrid grid{kSide, {first, first + kCells}};
    grid.cell_px = 8;
    page.drawing(report::grid_svg(grid));
  }
  page.end_row();
}

}  // namespace

report::Page curves_page(const std::string& title, const RunCurves& curves, const Json& config) {
  report::Page page(title);
  page.table(scene_table(curves, config));
  page.heading("Training");
  add_chart("loss: mean squared error of the training samples", {curves.loss, running_mean(curves.loss)}, true, page);
  add_chart("PSNR of the validation scenes, dB", curves.psnr_db, false, page);
  add_chart("events per pixel of the validation scenes", curves.events_per_pixel, false, page);
  add_chart("learning rate", {curves.learning_rate}, false, page);
  add_chart("samples per second", {curves.samples_per_s}, false, page);
  if (!curves.patterns.empty()) page.heading("Patterns");
  constexpr size_t kTimes = 8;
  const size_t shown = std::min(kTimes, curves.patterns.size());
  for (size_t i = 0; i < shown; ++i) {
    add_patterns(curves.patterns[shown == 1 ? 0 : i * (curves.patterns.size() - 1) / (shown - 1)], page);
  }
  if (!config.empty()) page.heading("Configuration").facts(config);
  return page;
}

}  // namespace e2lf::learn
