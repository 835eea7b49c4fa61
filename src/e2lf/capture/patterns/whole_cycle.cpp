// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/whole_cycle.h"

#include <algorithm>
#include <cmath>

namespace e2lf::capture {

Codes whole_cycle(const Codes& codes) {
  Codes whole(2 * codes.num_patterns + 1, codes.views_y, codes.views_x);
  const Codes inverses = complement(codes);
  auto end = std::copy(codes.values.begin(), codes.values.end(), whole.values.begin());
  end = std::copy(inverses.values.begin(), inverses.values.end(), end);
  std::copy_n(codes.values.begin(), codes.num_patterns > 0 ? codes.pattern_size() : 0, end);
  return whole;
}

std::optional<Codes> codes_of_whole_cycle(const Codes& codes) {
  constexpr float kRounding = 1e-6F;
  if (codes.num_patterns < 5 || codes.num_patterns % 2 == 0) return std::nullopt;
  Codes shown((codes.num_patterns - 1) / 2, codes.views_y, codes.views_x);
  std::copy_n(codes.values.begin(), shown.values.size(), shown.values.begin());
  const bool is_whole = std::equal(codes.values.begin(), codes.values.end(), whole_cycle(shown).values.begin(),
                                   [](float value, float expected) { return std::abs(value - expected) <= kRounding; });
  return is_whole ? std::optional(std::move(shown)) : std::nullopt;
}

}  // namespace e2lf::capture
