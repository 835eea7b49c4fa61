// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::report {

/// Round numbers along an axis: multiples of `step`, which is 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 1;
  int decimals = 0;  ///< that the numbers need
  std::vector<double> values;
};

/// The finest ticks of which at most `most` (2 or more) lie in [low, high]; ends count. `low` must be less than `high`,
/// both finite; else the contract is broken.
[[nodiscard]] Ticks round_ticks(double low, double high, size_t most);

/// Numbers along a logarithmic axis that enclose [low, high]: 1, 2 and 5 times powers of ten, or of many powers the
/// tens alone, or every so manyth; `most` at most, besides the two ends. Both must be positive and finite, low at most
/// high.
[[nodiscard]] std::vector<double> log_ticks(double low, double high, size_t most);

/// "28.50"; without "-" before zeros.
[[nodiscard]] std::string tick_text(double value, int decimals);

/// Maps [low, high] to [page_low, page_high]; either may run down.
struct Axis {
  double low = 0, high = 1, page_low = 0, page_high = 1;
  [[nodiscard]] double at(double value) const {
    return page_low + (page_high - page_low) * (value - low) / (high - low);
  }
};

}  // namespace e2lf::report
