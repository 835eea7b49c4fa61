// SPDX-License-Identifier: MIT
#include "e2lf/recon/inversion.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/intensity_table.h"

namespace e2lf::recon {
namespace {

constexpr size_t kMinChunk = 4096;

int sign(int value) {
  return (value > 0) - (value < 0);
}

Result<void> check(const capture::EventImages& images, const InversionOptions& options) {
  E2LF_RETURN_IF_ERROR(IntensityTable::check(options.constants));
  if (options.black <= images.count) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("the black pattern is number ", options.black, " but there are ", images.count + 1,
                   " patterns; count from 0"),
               ""};
}

/// The possible log intensities of a pixel, in thresholds.
struct Interval {
  int lower = 0, upper = 0;
};

Interval operator+(Interval a, Interval b) {
  return {a.lower + b.lower, a.upper + b.upper};
}
Interval operator-(Interval a) {
  return {-a.upper, -a.lower};
}

/// E + R(E).
Interval counted(int count) {
  return {count - (count <= 0 ? 1 : 0), count + (count >= 0 ? 1 : 0)};
}

/// Computes the intervals of one pixel for all patterns, relative to the black one.
void pixel_intervals(std::span<const int> counts, size_t black, Counting counting, std::span<Interval> intervals) {
  const auto step = [&](size_t k) -> Interval {
    return counting == Counting::kQuantised ? counted(counts[k]) : Interval{counts[k], counts[k]};
  };
  intervals[black] = {};
  for (size_t n = black; n + 1 < intervals.size(); ++n) intervals[n + 1] = intervals[n] + step(n);
  for (size_t n = black; n-- > 0;) intervals[n] = intervals[n + 1] + -step(n);
  if (counting == Counting::kQuantised) return;
  // The counted levels are exact. The log intensities differ from them by the residual at either end.
  const auto rest = [&](size_t n) -> Interval {
    return n == 0 ? Interval{} : counted(counts[n - 1]) + Interval{-counts[n - 1], -counts[n - 1]};
  };
  for (size_t n = 0; n < intervals.size(); ++n) {
    if (n != black) intervals[n] = intervals[n] + rest(n) + -rest(black);
  }
}

}  // namespace

Result<capture::CodedIntensities> invert_events(const capture::EventImages& images, const InversionOptions& options) {
  E2LF_RETURN_IF_ERROR(check(images, options));
  const IntensityTable table(options.constants);
  const size_t num_patterns = images.count + 1;
  capture::CodedIntensities intensities(num_patterns, images.height, images.width);
  parallel_for(images.image_size(), kMinChunk, [&](size_t begin, size_t end) {
    std::vector<int> levels(num_patterns);  // in half thresholds, relative to the first pattern
    for (size_t pixel = begin; pixel < end; ++pixel) {
      int total = 0, last_change = 0;
      for (size_t k = 0; k < images.count; ++k) {
        const int count = images.image(k)[pixel];
        total += count;
        if (count != 0) last_change = sign(count);
        levels[k + 1] = 2 * total + (options.centred ? last_change : 0);
      }
      for (size_t n = 0; n < num_patterns; ++n) {
        intensities.image(n)[pixel] = table.at_half_steps(levels[n] - levels[options.black]);
      }
    }
  });
  return intensities;
}

Result<IntensityBounds> intensity_bounds(const capture::EventImages& images, const InversionOptions& options,
                                         Counting counting) {
  E2LF_RETURN_IF_ERROR(check(images, options));
  const IntensityTable table(options.constants);
  const size_t num_patterns = images.count + 1;
  IntensityBounds bounds;
  bounds.lower = bounds.upper = capture::CodedIntensities(num_patterns, images.height, images.width);
  parallel_for(images.image_size(), kMinChunk, [&](size_t begin, size_t end) {
    std::vector<int> counts(images.count);
    std::vector<Interval> intervals(num_patterns);
    for (size_t pixel = begin; pixel < end; ++pixel) {
      for (size_t k = 0; k < images.count; ++k) counts[k] = images.image(k)[pixel];
      pixel_intervals(counts, options.black, counting, intervals);
      for (size_t n = 0; n < num_patterns; ++n) {
        bounds.lower.image(n)[pixel] = std::max(0.0F, table.at_half_steps(2 * intervals[n].lower));
        bounds.upper.image(n)[pixel] = std::max(0.0F, table.at_half_steps(2 * intervals[n].upper));
      }
    }
  });
  return bounds;
}

capture::EventImages permute_events(const capture::EventImages& images, std::span<const size_t> order) {
  std::vector<size_t> sorted(order.begin(), order.end());
  std::sort(sorted.begin(), sorted.end());
  E2LF_REQUIRE(sorted.size() == images.count + 1, "an order must hold every pattern");
  for (size_t n = 0; n < sorted.size(); ++n) E2LF_REQUIRE(sorted[n] == n, "an order must hold every pattern once");

  capture::EventImages permuted(images.count, images.height, images.width);
  parallel_for(images.image_size(), kMinChunk, [&](size_t begin, size_t end) {
    std::vector<int> levels(order.size());
    for (size_t pixel = begin; pixel < end; ++pixel) {
      for (size_t k = 0; k < images.count; ++k) levels[k + 1] = levels[k] + images.image(k)[pixel];
      for (size_t k = 0; k < images.count; ++k) {
        permuted.image(k)[pixel] = capture::saturated(levels[order[k + 1]] - levels[order[k]]);
      }
    }
  });
  return permuted;
}

}  // namespace e2lf::recon
