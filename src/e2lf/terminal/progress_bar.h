// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

#include "e2lf/base/progress.h"

namespace e2lf {

/// Draws one line on stderr, at most ten times a second: a bar with the percentage and the remaining time, or, if the
/// total is unknown (0), the number of parts done. It draws nothing if stderr is not a terminal or if `quiet` is set.
/// The destructor removes the line. Only one bar is drawn at a time.
class ProgressBar {
 public:
  /// `unit` names what is counted, in the plural; it is shown if the total is unknown.
  explicit ProgressBar(std::string label, bool quiet = false, std::string unit = "");
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(size_t done, size_t total);

  /// Returns a callback that draws on this bar. The bar must outlive it.
  [[nodiscard]] ProgressFn callback();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_, unit_;
  bool active_;
  bool drawn_ = false;
  Clock::time_point begin_;
  Clock::time_point last_draw_;
};

/// Removes the current line until the next update, so that another message can be written to stderr.
void hide_progress();

/// Formats the line of the bar, e.g. "reconstruct  [#####.....]  50 %  3 s left", or, with a total of 0, "convert  1200
/// events  3 s". It is a separate function so that it can be tested.
[[nodiscard]] std::string progress_line(const std::string& label, size_t done, size_t total, double elapsed_s,
                                        const std::string& unit = "");

}  // namespace e2lf
