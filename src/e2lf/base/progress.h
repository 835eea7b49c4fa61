// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace e2lf {

/// Called by long work with the parts done so far and in all, from one thread at a time; an empty function is silence.
using ProgressFn = std::function<void(size_t done, size_t total)>;

/// A bar with percentage and remaining time on stderr, redrawn at most ten times a second; silent when stderr is not a
/// terminal or when made quiet. The destructor ends the line.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label, bool quiet = false);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(size_t done, size_t total);

  /// A callback that draws on this bar; the bar must outlive it.
  [[nodiscard]] ProgressFn callback();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool active_;
  bool drawn_ = false;
  Clock::time_point begin_;
  Clock::time_point last_draw_;
};

/// The bar's line, e.g. "reconstruct  [#####.....]  50 %  3 s left"; separate so that it can be tested.
[[nodiscard]] std::string progress_line(const std::string& label, size_t done, size_t total, double elapsed_s);

}  // namespace e2lf
