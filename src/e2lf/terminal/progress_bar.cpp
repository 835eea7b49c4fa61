// SPDX-License-Identifier: MIT
#include "e2lf/terminal/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <unistd.h>

#include "e2lf/base/text.h"

namespace e2lf {
namespace {

/// The line at the bottom of the terminal. The mutex is needed because messages come from several threads.
struct Line {
  std::mutex mutex;
  bool is_drawn = false;
};

Line& line() {
  static Line the_line;
  return the_line;
}

}  // namespace

std::string progress_line(const std::string& label, size_t done, size_t total, double elapsed_s,
                          const std::string& unit) {
  if (total == 0) return cat(label, "  ", done, " ", unit, "  ", static_cast<long>(elapsed_s), " s");
  constexpr size_t kCells = 30;
  const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const auto filled = static_cast<size_t>(share * kCells);
  std::string line = cat(label, "  [", std::string(filled, '#'), std::string(kCells - filled, '.'), "] ",
                         static_cast<int>(share * 100.0), " %");
  if (share > 0.0 && share < 1.0 && elapsed_s > 0.5) {
    const auto left_s = static_cast<long>(std::ceil(elapsed_s * (1.0 - share) / share));
    if (left_s >= 3600) {
      line += cat("  ", left_s / 3600, " h ", left_s % 3600 / 60, " min left");
    } else if (left_s >= 60) {
      line += cat("  ", left_s / 60, " min ", left_s % 60, " s left");
    } else {
      line += cat("  ", left_s, " s left");
    }
  }
  return line;
}

void hide_progress() {
  const std::lock_guard lock(line().mutex);
  if (!line().is_drawn) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  line().is_drawn = false;
}

ProgressBar::ProgressBar(std::string label, bool quiet, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      active_(!quiet && ::isatty(STDERR_FILENO) == 1),
      logs_(!quiet && !active_),
      begin_(Clock::now()),
      last_draw_(begin_) {}

ProgressBar::~ProgressBar() {
  if (drawn_) hide_progress();
}

bool is_line_due(size_t tenths, size_t last_tenths, double since_last_s) {
  constexpr double kLeastS = 20;
  return tenths > last_tenths && since_last_s >= kLeastS;
}

void ProgressBar::log(size_t done, size_t total, Clock::time_point now) {
  if (total == 0 || done >= total) return;
  const size_t tenths = 10 * done / total;
  if (!is_line_due(tenths, tenths_, std::chrono::duration<double>(now - last_draw_).count())) return;
  tenths_ = tenths;
  last_draw_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  std::fprintf(stderr, "e2lf: %s\n", progress_line(label_, done, total, elapsed_s, unit_).c_str());
}

void ProgressBar::update(size_t done, size_t total) {
  if (!active_ && !logs_) return;
  const Clock::time_point now = Clock::now();
  if (logs_) return log(done, total, now);
  const bool is_last = total > 0 && done >= total;
  if (drawn_ && !is_last && now - last_draw_ < std::chrono::milliseconds(100)) return;
  last_draw_ = now;
  drawn_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  const std::lock_guard lock(line().mutex);
  // "Erase to end of line" clears the remains of a longer line.
  std::fprintf(stderr, "\r%s\x1b[K", progress_line(label_, done, total, elapsed_s, unit_).c_str());
  std::fflush(stderr);
  line().is_drawn = true;
}

}  // namespace e2lf
