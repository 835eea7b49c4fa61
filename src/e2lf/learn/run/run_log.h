// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/report/page.h"

namespace e2lf::learn {

/// One row of log.csv.
struct StepRow {
  uint64_t step = 0, samples = 0;
  double loss = 0;
  double figure = 0;  ///< mean squared error, or the share of disparities that are off
  double learning_rate = 0, gradient_norm = 0, samples_per_s = 0;
  double open_cells = 0;  ///< sum over the cells of all patterns
  double binarity = 0;    ///< mean of |2 a - 1| over the cells: 0 if all are 1/2, 1 if all are 0 or 1
};

/// The result of one scene.
struct SceneScore {
  std::string name;
  /// PSNR in dB, the mean over the views of the output, clamped to [0, 1]; or the share of disparities that are off, %.
  double score = 0;
  double events_per_pixel = 0;
};

/// The columns and curves in which networks of views and of disparity differ.
struct LogFigures {
  const char *step_column, *score_column;  ///< in log.csv and evaluation.csv
  const char *step_heading, *score_heading;
  bool is_squared_error;  ///< the figure of a step, which is drawn as a PSNR in decibels; otherwise it is a share

  [[nodiscard]] static LogFigures of_views();
  [[nodiscard]] static LogFigures of_disparity();
};

/// The tables of a training run, one .csv file each in its folder, and the page of curves that is drawn from them.
class RunLog {
 public:
  RunLog(std::filesystem::path folder, const LogFigures& figures) : folder_(std::move(folder)), figures_(figures) {}

  /// Removes the rows after a step, which a run that was killed after its last checkpoint would otherwise contain
  /// twice.
  [[nodiscard]] Result<void> rewind(uint64_t step) const;

  /// Returns the names of the files that the log writes.
  [[nodiscard]] static std::vector<std::string> file_names();

  /// Adds a row to log.csv, to evaluation.csv, and to patterns.csv. `cells` are those of all patterns, in [0, 1].
  [[nodiscard]] Result<void> add(const StepRow& row) const;
  [[nodiscard]] Result<void> add(uint64_t step, uint64_t samples, const SceneScore& score) const;
  [[nodiscard]] Result<void> add(uint64_t step, uint64_t samples, std::span<const float> cells) const;

  /// Draws the content of the tables and the configuration as curves.html, which is self-contained.
  [[nodiscard]] Result<void> draw_curves(const std::string& title, const Json& config) const;

 private:
  std::filesystem::path folder_;
  LogFigures figures_;
};

}  // namespace e2lf::learn
