// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/report/chart.h"
#include "e2lf/report/page.h"

namespace e2lf::learn {

/// The patterns at one point of a run: 8x8 cells in [0, 1] each, row by row, one pattern after another.
struct PatternState {
  double samples = 0;
  std::vector<double> cells;
};

/// The course of a training run over the number of samples seen (x).
struct RunCurves {
  report::Line loss, learning_rate, samples_per_s;
  std::vector<report::Line> psnr_db, events_per_pixel;  ///< one line per validation scene, by its name
  std::vector<PatternState> patterns;
};

/// Creates a page with the results of the validation, the loss on a logarithmic axis with its running mean, PSNR,
/// events per pixel, learning rate and speed, the patterns at up to eight points of the run, and the configuration.
[[nodiscard]] report::Page curves_page(const std::string& title, const RunCurves& curves, const Json& config);

}  // namespace e2lf::learn
