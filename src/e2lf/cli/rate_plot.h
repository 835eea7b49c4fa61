// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/events/event.h"

namespace e2lf::cli {

/// ON and OFF events per time bin over a recording of any length in bounded memory: whenever there are too many bins,
/// neighbours are merged and the bin width doubles.
class RateSeries {
 public:
  static constexpr size_t kMaxBins = 2048;

  /// Counts the events; time ascends from call to call, but for jitter.
  void add(const events::EventColumns& events);

  [[nodiscard]] int64_t first_us() const { return first_us_; }
  [[nodiscard]] int64_t bin_us() const { return bin_us_; }
  [[nodiscard]] const std::vector<uint64_t>& on() const { return on_; }
  [[nodiscard]] const std::vector<uint64_t>& off() const { return off_; }

 private:
  void merge_bins();
  int64_t first_us_ = 0;
  int64_t bin_us_ = 100;
  bool started_ = false;
  std::vector<uint64_t> on_, off_;
};

/// The event rate over time as an SVG picture: ON above the axis, OFF below, with axes in ms and M events/s.
[[nodiscard]] std::string rate_plot_svg(const RateSeries& series);

}  // namespace e2lf::cli
