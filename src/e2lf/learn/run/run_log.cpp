// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/run_log.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/learn/run/curves.h"

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
  if (!out.flush()) return Error{ErrorCode::kIo, "could not append; check the disk", path.string()};
  return {};
}

/// Returns the lines of a table without its header, or none if there is no such file.
std::vector<std::string> table_lines(const std::filesystem::path& path) {
  std::vector<std::string> lines;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  if (!lines.empty()) lines.erase(lines.begin());
  return lines;
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) result.push_back(field);
  return result;
}

double number(const std::string& field) {
  return std::strtod(field.c_str(), nullptr);
}

Result<void> rewind_table(const std::filesystem::path& path, uint64_t step) {
  std::ifstream in(path);
  if (!in) return {};
  std::string kept, line;
  std::getline(in, line);
  kept = line + '\n';
  bool changed = false;
  while (std::getline(in, line)) {
    const bool keep = number(line) <= static_cast<double>(step);
    if (keep) kept += line + '\n';
    changed = changed || !keep;
  }
  if (!changed) return {};
  return write_file(path, kept);
}

}  // namespace

std::vector<std::string> RunLog::file_names() {
  return {kSteps, kScores, kPatterns, kCurves};
}

Result<void> RunLog::rewind(uint64_t step) const {
  for (const char* table : {kSteps, kScores, kPatterns}) E2LF_RETURN_IF_ERROR(rewind_table(folder_ / table, step));
  return {};
}

Result<void> RunLog::add(const StepRow& row) const {
  return append_line(folder_ / kSteps,
                     "step,samples,loss,mse,learning_rate,gradient_norm,samples_per_s,open_cells,binarity",
                     cat(row.step, ',', row.samples, ',', row.loss, ',', row.mse, ',', row.learning_rate, ',',
                         row.gradient_norm, ',', row.samples_per_s, ',', row.open_cells, ',', row.binarity));
}

Result<void> RunLog::add(const ScoreRow& row) const {
  return append_line(folder_ / kScores, "step,samples,scene,psnr_db,events_per_pixel",
                     cat(row.step, ',', row.samples, ',', row.scene, ',', row.psnr_db, ',', row.events_per_pixel));
}

Result<void> RunLog::add(const PatternRow& row) const {
  std::string line = cat(row.step, ',', row.samples);
  for (const float cell : row.cells) line += cat(',', static_cast<double>(static_cast<int>(cell * 1000)) / 1000);
  return append_line(folder_ / kPatterns, "step,samples,cells of pattern 0 row by row then pattern 1 ...", line);
}

report::Page RunLog::page(const std::string& title, const Json& config) const {
  RunCurves curves;
  curves.loss.name = "mean squared error";
  for (const std::string& line : table_lines(folder_ / kSteps)) {
    const auto field = fields(line);
    if (field.size() < 7) continue;
    const double samples = number(field[1]);
    curves.loss.points.push_back({samples, number(field[3])});
    curves.learning_rate.points.push_back({samples, number(field[4])});
    curves.samples_per_s.points.push_back({samples, number(field[6])});
  }
  for (const std::string& line : table_lines(folder_ / kScores)) {
    const auto field = fields(line);
    if (field.size() < 5) continue;
    const auto same = [&](const report::Line& curve) { return curve.name == field[2]; };
    const auto found = std::find_if(curves.psnr_db.begin(), curves.psnr_db.end(), same) - curves.psnr_db.begin();
    const auto scene = static_cast<size_t>(found);
    if (scene == curves.psnr_db.size()) {
      curves.psnr_db.push_back({field[2], {}});
      curves.events_per_pixel.push_back({field[2], {}});
    }
    curves.psnr_db[scene].points.push_back({number(field[1]), number(field[3])});
    curves.events_per_pixel[scene].points.push_back({number(field[1]), number(field[4])});
  }
  for (const std::string& line : table_lines(folder_ / kPatterns)) {
    const auto field = fields(line);
    PatternState state{field.size() > 1 ? number(field[1]) : 0, {}};
    for (size_t i = 2; i < field.size(); ++i) state.cells.push_back(number(field[i]));
    curves.patterns.push_back(std::move(state));
  }
  return curves_page(title, curves, config);
}

Result<void> RunLog::draw_curves(const std::string& title, const Json& config) const {
  return write_file(folder_ / kCurves, page(title, config).html());
}

}  // namespace e2lf::learn
