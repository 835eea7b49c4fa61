// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::learn {

/// y over the samples seen.
struct Curve {
  struct Point {
    double samples = 0, y = 0;
  };
  std::string name;
  std::vector<Point> points;
};

/// The patterns at one time: 8x8 cells in [0, 1] each, row by row, one pattern after another.
struct PatternState {
  double samples = 0;
  std::vector<double> cells;
};

/// A page of HTML with nothing outside it: the loss on a logarithmic axis, its running mean; PSNR in dB; the patterns
/// at up to eight times.
[[nodiscard]] std::string curves_page(const std::string& title, const Curve& loss, const std::vector<Curve>& psnr_db,
                                      const std::vector<PatternState>& patterns);

}  // namespace e2lf::learn
