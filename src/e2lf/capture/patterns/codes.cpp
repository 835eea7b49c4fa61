// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/codes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "e2lf/base/text.h"

namespace e2lf::capture {

Result<void> validate(const Codes& codes, const std::string& location) {
  if (codes.values.empty())
    return Error{ErrorCode::kShape, "there are no aperture patterns; give at least one", location};
  if (codes.values.size() != codes.num_patterns * codes.pattern_size()) {
    return Error{ErrorCode::kShape,
                 cat(codes.values.size(), " transmittances do not make patterns of ",
                     shape_text({codes.num_patterns, codes.views_y, codes.views_x}), "; give one for each cell"),
                 location};
  }
  // Written so that NaN is refused.
  const auto refused =
      std::find_if(codes.values.begin(), codes.values.end(), [](float v) { return !(v >= 0.0F && v <= 1.0F); });
  if (refused == codes.values.end()) return {};
  const auto index = static_cast<size_t>(refused - codes.values.begin());
  const size_t cell = index % codes.pattern_size();
  return Error{ErrorCode::kInvalidValue,
               cat("the transmittance ", *refused, " of pattern ", index / codes.pattern_size() + 1, ", row ",
                   cell / codes.views_x, ", column ", cell % codes.views_x, " is not in [0, 1]; scale the patterns"),
               location};
}

bool is_black_first(const Codes& codes) {
  if (codes.num_patterns == 0) return false;
  const auto first = codes.pattern(0);
  return std::all_of(first.begin(), first.end(), [](float value) { return value == 0.0F; });
}

bool is_binary(const Codes& codes) {
  return std::all_of(codes.values.begin(), codes.values.end(),
                     [](float value) { return value == 0.0F || value == 1.0F; });
}

std::vector<float> light_efficiency(const Codes& codes) {
  std::vector<float> means;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    const auto pattern = codes.pattern(n);
    const double sum = std::accumulate(pattern.begin(), pattern.end(), 0.0);
    means.push_back(static_cast<float>(sum / static_cast<double>(pattern.size())));
  }
  return means;
}

Codes complement(const Codes& codes) {
  Codes result = codes;
  for (float& value : result.values) value = 1.0F - value;
  return result;
}

Codes permuted(const Codes& codes, std::span<const size_t> order) {
  E2LF_REQUIRE(order.size() == codes.num_patterns, "the order needs one number for each pattern");
  Codes result(codes.num_patterns, codes.views_y, codes.views_x);
  std::vector<bool> used(order.size());
  for (size_t n = 0; n < order.size(); ++n) {
    E2LF_REQUIRE(order[n] < used.size() && !used[order[n]], "the order holds each pattern once");
    used[order[n]] = true;
    const auto source = codes.pattern(order[n]);
    std::copy(source.begin(), source.end(), result.pattern(n).begin());
  }
  return result;
}

Codes default_codes() {
  constexpr size_t kViews = 8;
  constexpr float kNear = 1.5F, kFar = 5.5F;  // centres of the first and second half of an axis
  constexpr float kCentres[3][2] = {{kFar, kNear}, {kFar, kFar}, {kNear, kFar}};  // {view_y, view_x}
  constexpr float kRadiusSquared = 3.0F;                                          // a 4x4 square without its corners
  Codes codes(4, kViews, kViews);
  for (size_t n = 1; n < codes.num_patterns; ++n) {
    for (size_t view_y = 0; view_y < kViews; ++view_y) {
      for (size_t view_x = 0; view_x < kViews; ++view_x) {
        const float dy = static_cast<float>(view_y) - kCentres[n - 1][0];
        const float dx = static_cast<float>(view_x) - kCentres[n - 1][1];
        if (dy * dy + dx * dx <= kRadiusSquared) codes.pattern(n)[view_y * kViews + view_x] = 1.0F;
      }
    }
  }
  return codes;
}

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
