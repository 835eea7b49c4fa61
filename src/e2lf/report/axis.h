// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::report {

/// Round numbers along an axis: multiples of `step`, which is 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 1;
  int decimals = 0;  ///< number of decimals that the values need
  std::vector<double> values;
};

/// Returns the finest ticks of which at most `most` (>= 2) lie in [low, high], ends included. The contract is broken
/// unless both are finite and `low` is less than `high`.
[[nodiscard]] Ticks round_ticks(double low, double high, size_t most);

/// Returns ticks of a logarithmic axis that enclose [low, high]: 1, 2 and 5 times powers of ten, or only powers of ten
/// if the range is large, or only every n-th power. There are at most `most` of them besides the two ends. Both limits
/// must be positive and finite, with low <= high.
[[nodiscard]] std::vector<double> log_ticks(double low, double high, size_t most);

/// Formats a value as "28.50". Zero never gets a minus sign.
[[nodiscard]] std::string tick_text(double value, int decimals);

/// Maps [low, high] linearly to [page_low, page_high], either of which may be descending.
struct Axis {
  double low = 0, high = 1, page_low = 0, page_high = 1;
  [[nodiscard]] double at(double value) const {
    return page_low + (page_high - page_low) * (value - low) / (high - low);
  }
};

}  // namespace e2lf::report
