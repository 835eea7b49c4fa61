// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/run_log.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/report/chart.h"

namespace e2lf::learn {
namespace {

constexpr const char* kSteps = "log.csv";
constexpr const char* kScores = "evaluation.csv";
constexpr const char* kPatterns = "patterns.csv";
constexpr const char* kCurves = "curves.html";

Result<void> append_line(const std::filesystem::path& path, const std::string& header, const std::string& line) {
  const bool fresh = !std::filesystem::exists(path);
  std::ofstream out(path, std::ios::app);
  if (fresh) out << header << '\n';
  out << line << '\n';
  if (!out.flush()) return fail(ErrorCode::kIo, path, "could not append; check the disk");
  return {};
}

/// Returns the rows of a table with at least `least` cells, without its header; none if there is no such file.
std::vector<std::vector<std::string>> table_rows(const std::filesystem::path& path, size_t least) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(path);
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {
    if (auto cells = csv_cells(line); cells.size() >= least) rows.push_back(std::move(cells));
  }
  return rows;
}

double number(const std::string& field) {
  return std::strtod(field.c_str(), nullptr);
}

Result<void> rewind_table(const std::filesystem::path& path, uint64_t step) {
  std::ifstream in(path);
  std::string kept, line;
  bool changed = false;
  for (bool is_header = true; std::getline(in, line); is_header = false) {
    const bool keep = is_header || number(line) <= static_cast<double>(step);
    if (keep) kept += line + '\n';
    changed = changed || !keep;
  }
  return changed ? write_file(path, kept) : Result<void>();
}

/// The patterns at one point of a run: 8x8 cells in [0, 1] each, row by row, one pattern after another.
struct PatternState {
  double samples = 0;
  std::vector<double> cells;
};

/// The course of a training run over the number of samples seen (x).
struct RunCurves {
  report::Line loss, learning_rate, samples_per_s;
  std::vector<report::Line> score, events_per_pixel;  ///< one line per validation scene, by its name
  std::vector<PatternState> patterns;
};

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

void add_chart(const char* heading, std::vector<report::Line> lines, report::Page& page) {
  if (lines.empty() || lines.front().points.empty()) return;
  report::LineChart chart{"samples", heading, std::move(lines)};
  page.drawing(report::chart_svg(chart));
}

/// Returns the text above the results of the validation; before there are any, it states when the first ones will come.
std::string scenes_caption(const RunCurves& curves, const Json& config) {
  const auto setting = [&](const char* key) { return config.value(Json::json_pointer(key), uint64_t{0}); };
  const uint64_t step = std::min(setting("/train/evaluate_steps"), setting("/train/steps"));
  if (!curves.score.empty() || step == 0) return "Validation scenes.";
  return cat("Validation scenes: the first evaluation comes after step ", step, ", that is after ",
             step * setting("/train/batch"), " samples.");
}

/// Adds a table of the last and the best results of each scene.
report::Table scene_table(const RunCurves& curves, const LogFigures& figures, const Json& config) {
  report::Table table{scenes_caption(curves, config),
                      {{"scene"},
                       {figures.score_heading, true, false, figures.score_column},
                       {cat("best ", figures.score_heading), true, false, cat("best_", figures.score_column)},
                       {"best after samples", true, false, "best_samples"},
                       {"events per pixel", true, false, "events_per_pixel"}},
                      {}};
  for (size_t i = 0; i < curves.score.size(); ++i) {
    const auto& points = curves.score[i].points;
    const auto best = std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return figures.is_squared_error ? a.y < b.y : a.y > b.y;
    });
    table.rows.push_back({report::text_cell(curves.score[i].name), report::number_cell(points.back().y, 2),
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
    page.drawing(report::grid_svg({first, first + kCells}, kSide));
  }
  page.end_row();
}

/// Creates a page with the results of the validation, the loss in decibels with its running mean, PSNR,
/// events per pixel, learning rate and speed, the patterns at up to eight points of the run, and the configuration.
report::Page curves_page(const std::string& title, const RunCurves& curves, const LogFigures& figures,
                         const Json& config) {
  report::Page page(title);
  page.table(scene_table(curves, figures, config));
  page.heading("Training");
  add_chart(figures.step_heading, {curves.loss, running_mean(curves.loss)}, page);
  add_chart(cat(figures.score_heading, " of the validation scenes").c_str(), curves.score, page);
  add_chart("events per pixel of the validation scenes", curves.events_per_pixel, page);
  add_chart("learning rate", {curves.learning_rate}, page);
  add_chart("samples per second", {curves.samples_per_s}, page);
  if (!curves.patterns.empty()) page.heading("Patterns");
  constexpr size_t kTimes = 8;
  const size_t shown = std::min(kTimes, curves.patterns.size());
  for (size_t i = 0; i < shown; ++i) {
    add_patterns(curves.patterns[shown == 1 ? 0 : i * (curves.patterns.size() - 1) / (shown - 1)], page);
  }
  if (!config.empty()) page.heading("Configuration").facts(config);
  return page;
}

}  // namespace

LogFigures LogFigures::of_views() {
  return {"mse", "psnr_db", "loss: PSNR of the training samples, dB", "PSNR dB", true};
}

LogFigures LogFigures::of_disparity() {
  return {"share_off", "off_percent", "share of disparities that are off by more than 0.2 px",
          "disparities off by more than 0.2 px, %", false};
}

std::vector<std::string> RunLog::file_names() {
  return {kSteps, kScores, kPatterns, kCurves};
}

Result<void> RunLog::rewind(uint64_t step) const {
  for (const char* table : {kSteps, kScores, kPatterns}) E2LF_RETURN_IF_ERROR(rewind_table(folder_ / table, step));
  return {};
}

Result<void> RunLog::add(const StepRow& row) const {
  return append_line(
      folder_ / kSteps,
      cat("step,samples,loss,", figures_.step_column, ",learning_rate,gradient_norm,samples_per_s,open_cells,binarity"),
      cat(row.step, ',', row.samples, ',', row.loss, ',', row.figure, ',', row.learning_rate, ',', row.gradient_norm,
          ',', row.samples_per_s, ',', row.open_cells, ',', row.binarity));
}

Result<void> RunLog::add(uint64_t step, uint64_t samples, const SceneScore& score) const {
  return append_line(folder_ / kScores, cat("step,samples,scene,", figures_.score_column, ",events_per_pixel"),
                     cat(step, ',', samples, ',', csv_cell(score.name), ',', score.score, ',', score.events_per_pixel));
}

Result<void> RunLog::add(uint64_t step, uint64_t samples, std::span<const float> cells) const {
  std::string line = cat(step, ',', samples);
  for (const float cell : cells) line += cat(',', static_cast<double>(static_cast<int>(cell * 1000)) / 1000);
  return append_line(folder_ / kPatterns, "step,samples,cells of pattern 0 row by row then pattern 1 ...", line);
}

Result<void> RunLog::draw_curves(const std::string& title, const Json& config) const {
  RunCurves curves;
  curves.loss.name = "of each row";
  for (const auto& field : table_rows(folder_ / kSteps, 7)) {
    const double samples = number(field[1]);
    const double figure = number(field[3]);
    curves.loss.points.push_back({samples, figures_.is_squared_error ? -10 * std::log10(figure) : figure});
    curves.learning_rate.points.push_back({samples, number(field[4])});
    curves.samples_per_s.points.push_back({samples, number(field[6])});
  }
  for (const auto& field : table_rows(folder_ / kScores, 5)) {
    const auto found = std::ranges::find(curves.score, field[2], &report::Line::name);
    const auto scene = static_cast<size_t>(found - curves.score.begin());
    if (scene == curves.score.size()) {
      curves.score.push_back({field[2], {}});
      curves.events_per_pixel.push_back({field[2], {}});
    }
    curves.score[scene].points.push_back({number(field[1]), number(field[3])});
    curves.events_per_pixel[scene].points.push_back({number(field[1]), number(field[4])});
  }
  for (const auto& field : table_rows(folder_ / kPatterns, 2)) {
    PatternState state{number(field[1]), {}};
    for (size_t i = 2; i < field.size(); ++i) state.cells.push_back(number(field[i]));
    curves.patterns.push_back(std::move(state));
  }
  return write_file(folder_ / kCurves, curves_page(title, curves, figures_, config).html());
}

}  // namespace e2lf::learn
