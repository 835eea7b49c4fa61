// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace e2lf {

/// Called by long work with the parts done so far and in all, from one thread at a time; an empty function is silence.
using ProgressFn = std::function<void(size_t done, size_t total)>;

/// One line on stderr, redrawn at most ten times a second: a bar with percentage and remaining time, or, where the
/// total is not known (0), what is done so far. Silent when stderr is not a terminal or when made quiet. The destructor
/// takes the line away. One bar is drawn at a time.
class ProgressBar {
 public:
  /// `unit`: what is counted, in the plural, for totals that are not known.
  explicit ProgressBar(std::string label, bool quiet = false, std::string unit = "");
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(size_t done, size_t total);

  /// A callback that draws on this bar; the bar must outlive it.
  [[nodiscard]] ProgressFn callback();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_, unit_;
  bool active_;
  bool drawn_ = false;
  Clock::time_point begin_;
  Clock::time_point last_draw_;
};

/// Takes the line that is drawn away until the next update, so that something else can be said on stderr.
void hide_progress();

/// The bar's line, e.g. "reconstruct  [#####.....]  50 %  3 s left", with a total of 0 "convert  1200 events  3 s";
/// separate so that it can be tested.
[[nodiscard]] std::string progress_line(const std::string& label, size_t done, size_t total, double elapsed_s,
                                        const std::string& unit = "");

}  // namespace e2lf
