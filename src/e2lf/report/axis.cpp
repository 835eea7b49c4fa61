// SPDX-License-Identifier: MIT
#include "e2lf/report/axis.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "e2lf/base/result.h"

namespace e2lf::report {
namespace {

/// The multiples of a step in a range. A multiple that is outside by a billionth of a step counts as inside, because
/// decimal steps are not exact as doubles.
struct Multiples {
  double first, last;
  Multiples(double low, double high, double step)
      : first(std::ceil(low / step - 1e-9)), last(std::floor(high / step + 1e-9)) {}
  [[nodiscard]] double count() const { return std::max(last - first + 1, 0.0); }
};

}  // namespace

Ticks round_ticks(double low, double high, size_t most) {
  E2LF_REQUIRE(std::isfinite(low) && std::isfinite(high) && low < high && most >= 2, "an axis needs a range");
  // A step of a tenth of this gives more than `most` ticks in any case.
  int exponent = static_cast<int>(std::floor(std::log10((high - low) / static_cast<double>(most)))) - 1;
  for (;; ++exponent) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      Ticks ticks;
      ticks.step = factor * std::pow(10.0, exponent);
      const Multiples multiples(low, high, ticks.step);
      if (multiples.count() > static_cast<double>(most)) continue;
      ticks.decimals = std::max(-exponent, 0);
      for (double i = multiples.first; i <= multiples.last; ++i) ticks.values.push_back(i * ticks.step);
      return ticks;
    }
  }
}

std::vector<double> log_ticks(double low, double high, size_t most) {
  E2LF_REQUIRE(std::isfinite(low) && std::isfinite(high) && low > 0 && low <= high && most >= 2,
               "a logarithmic axis needs a range of positive numbers");
  const auto enclosing = [&](const std::vector<double>& factors, int decades) {
    std::vector<double> values;
    const int first = static_cast<int>(std::floor(std::log10(low) / decades - 1e-9)) * decades;
    for (int exponent = first; values.size() < 2 || values.back() < high; exponent += decades) {
      for (const double factor : factors) values.push_back(factor * std::pow(10.0, exponent));
    }
    // Drops the ticks outside of the range, except for the last one before it and the first one after it.
    while (values.size() > 2 && values[1] <= low) values.erase(values.begin());
    while (values.size() > 2 && values[values.size() - 2] >= high) values.pop_back();
    return values;
  };
  for (const std::vector<double>& factors : {std::vector{1.0, 2.0, 5.0}, std::vector{1.0}}) {
    std::vector<double> values = enclosing(factors, 1);
    if (values.size() <= most + 2) return values;
  }
  for (int decades = 2;; ++decades) {
    std::vector<double> values = enclosing({1.0}, decades);
    if (values.size() <= most + 2) return values;
  }
}

std::string tick_text(double value, int decimals) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(decimals) << value;
  std::string text = std::move(out).str();
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')) text.erase(0, 1);
  return text;
}

}  // namespace e2lf::report
