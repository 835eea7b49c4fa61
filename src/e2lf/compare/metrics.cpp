// SPDX-License-Identifier: MIT
#include "e2lf/compare/metrics.h"

#include <algorithm>

namespace e2lf::compare {

std::span<const Metric> all_metrics() {
  static constexpr Metric kMetrics[] = {
      {"psnr_db", "PSNR", 2, false, true, true},
      {"ssim", "SSIM", 4, false, true, true},
      {"ssim_gaussian", "SSIM (Gauss)", 4, false, true, true},
      {"epi_error", "EPI error", 3, true, true, true},
      {"bad_07_percent", "disparity > 0.07 px, %", 1, true, true, true},
      {"bad_20_percent", "disparity > 0.2 px, %", 1, true, true, true},
      {"disparity_error_px", "disparity error, px", 3, true, true, true},
      {"disparity_slope", "disparity slope", 2, false, true, true},
      {"events_per_pixel", "events/px", 3, true, false, true},
      {"bits_per_pixel", "bits per LF px", 2, true, false, true},
      {"measurement_ms", "measured ms", 1, true, false, true},
      {"cycle_ms", "cycle ms", 1, true, false, true},
      {"reconstruct_s", "reconstruction s", 2, true, false, false},
  };
  return kMetrics;
}

std::vector<Metric> metrics_of(const std::vector<std::string>& names) {
  std::vector<Metric> metrics;
  for (const Metric& metric : all_metrics()) {
    if (std::find(names.begin(), names.end(), metric.name) != names.end()) metrics.push_back(metric);
  }
  return metrics;
}

}  // namespace e2lf::compare
