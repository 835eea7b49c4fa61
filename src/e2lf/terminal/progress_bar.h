// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

#include "e2lf/base/progress.h"

namespace e2lf {

/// Draws one line on stderr, at most ten times a second: a bar with the percentage and the remaining time, or, if the
/// total is unknown (0), the number of parts done. The destructor removes the line. Only one bar is drawn at a time. If
/// stderr is not a terminal, each tenth of the total logs a line, but at most one in 20 s. With `quiet`, there is
/// none.
class ProgressBar {
 public:
  /// `unit` names what is counted, in the plural; it is shown if the total is unknown.
  explicit ProgressBar(std::string label, bool quiet = false, std::string unit = "");
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(size_t done, size_t total);

  /// Returns a callback that draws on this bar. The bar must outlive it.
  [[nodiscard]] ProgressFn callback() {
    return [this](size_t done, size_t total) { update(done, total); };
  }

 private:
  using Clock = std::chrono::steady_clock;
  void log(size_t done, size_t total, Clock::time_point now);

  std::string label_, unit_;
  bool active_, logs_;
  bool drawn_ = false;
  Clock::time_point begin_;
  Clock::time_point last_draw_;  ///< or line in the log
  size_t tenths_ = 0;            ///< at the last line in the log
};

/// Removes the current line until the next update, so that another message can be written to stderr.
void hide_progress();

/// Returns true if a log is due a line: 20 s after the last one, or after the beginning, in a later tenth of the
/// total.
[[nodiscard]] bool is_line_due(size_t tenths, size_t last_tenths, double since_last_s);

/// Formats the line of the bar, e.g. "reconstruct  [#####.....]  50 %  3 s left", or, with a total of 0, "convert  1200
/// events  3 s". It is a separate function so that it can be tested.
[[nodiscard]] std::string progress_line(const std::string& label, size_t done, size_t total, double elapsed_s,
                                        const std::string& unit = "");

}  // namespace e2lf
