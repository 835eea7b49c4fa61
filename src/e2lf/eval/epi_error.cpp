// SPDX-License-Identifier: MIT
#include "e2lf/eval/epi_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "e2lf/base/threads.h"

namespace e2lf::eval {
namespace {

using lightfield::LightField;

/// Sums over pixels and pairs of neighbouring views.
struct Sums {
  double error_squares = 0, truth_squares = 0;
  size_t count = 0;
};

/// Two neighbouring views that are compared in both light fields.
struct ViewPair {
  size_t view_y, view_x, next_y, next_x;
};

void add_pair(const LightField& truth, const LightField& reconstruction, const ViewPair& pair, bool clamp, Sums& sums) {
  const auto truth_here = truth.view(pair.view_y, pair.view_x), truth_next = truth.view(pair.next_y, pair.next_x);
  const auto here = reconstruction.view(pair.view_y, pair.view_x), next = reconstruction.view(pair.next_y, pair.next_x);
  const float low = clamp ? 0.0F : std::numeric_limits<float>::lowest();
  const float high = clamp ? 1.0F : std::numeric_limits<float>::max();
  for (size_t i = 0; i < here.size(); ++i) {
    const double truth_change = double{truth_next[i]} - double{truth_here[i]};
    const double change = double{std::clamp(next[i], low, high)} - double{std::clamp(here[i], low, high)};
    sums.error_squares += (change - truth_change) * (change - truth_change);
    sums.truth_squares += truth_change * truth_change;
  }
  sums.count += here.size();
}

}  // namespace

EpiError epi_error(const LightField& truth, const LightField& reconstruction, bool clamp) {
  E2LF_REQUIRE(truth.shape() == reconstruction.shape(), "light fields must have the same shape");
  const lightfield::Shape& shape = truth.shape();
  std::vector<Sums> sums(shape.num_views());
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const size_t y = view / shape.views_x, x = view % shape.views_x;
      if (x + 1 < shape.views_x) add_pair(truth, reconstruction, {y, x, y, x + 1}, clamp, sums[view]);
      if (y + 1 < shape.views_y) add_pair(truth, reconstruction, {y, x, y + 1, x}, clamp, sums[view]);
    }
  });
  Sums total;
  for (const Sums& part : sums) {
    total.error_squares += part.error_squares;
    total.truth_squares += part.truth_squares;
    total.count += part.count;
  }
  if (total.error_squares == 0) return {};
  return {std::sqrt(total.error_squares / static_cast<double>(total.count)),
          std::sqrt(total.error_squares / total.truth_squares)};
}

}  // namespace e2lf::eval
