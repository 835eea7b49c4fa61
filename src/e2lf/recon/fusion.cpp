// SPDX-License-Identifier: MIT
#include "e2lf/recon/fusion.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf::recon {
namespace {

using capture::PixelConstant;

constexpr size_t kBlock = 2;  // px along each axis that start again together
constexpr int kUnits = capture::kFusedUnits;
constexpr int kLevelsPerEvent = 4;  // of the table of variances
constexpr int kMostLevel = 64;      // in events; levels beyond have the variance of the last one
/// What is added to the variance of a count for its rounding. Of physical pixels, whose noise is small, most see the
/// same count in each cycle.
constexpr float kRounding = 1.0F / 12, kRoundingOfPixels = 1.0F / 60;
constexpr int kWeightBits = 14;
/// The effective number of cycles is tabulated up to this multiple of the number of cycles in a mean. It hardly grows
/// beyond.
constexpr size_t kSettled = 8;

/// Returns the variance of the log intensity with which a cycle compares, at a level above black in logarithm.
float level_variance(const capture::SensorProfile& camera, float level) {
  if (!camera.is_pixel()) return camera.constants.sigma_w * camera.constants.sigma_w;
  const capture::PixelConstants& pixel = camera.pixel;
  const float noise = pixel[PixelConstant::kNoise], shot = pixel[PixelConstant::kShotNoise];
  const float dark = pixel[PixelConstant::kDarkOff] + pixel[PixelConstant::kDarkOn];
  const float threshold = pixel[PixelConstant::kThresholdOn];
  return noise * noise + (shot * shot + dark * threshold * threshold) * std::exp(-std::max(0.0F, level));
}

/// Returns the variance of the reference after black.
float reference_variance(const capture::SensorProfile& camera) {
  if (!camera.is_pixel()) return 0;
  const float span = camera.pixel[PixelConstant::kResetSpan] * camera.pixel[PixelConstant::kThresholdOff];
  return span * span / 12;
}

/// Returns what a chi-squared variable with `freedom` degrees of freedom, divided by them, exceeds as rarely as a
/// normal one exceeds 4.5 standard deviations (Wilson and Hilferty 1931).
float limit_of(double freedom) {
  constexpr double kDeviations = 4.5;
  const double share = 2 / (9 * freedom);
  return static_cast<float>(std::pow(1 - share + kDeviations * std::sqrt(share), 3));
}

/// Returns the degrees of freedom of the mean of squares over the transitions, whose counts share the noise of the
/// level between them, so that the correlation of consecutive ones is -1/2; `of_each` is the number for one transition.
double freedom_of(size_t transitions, double of_each) {
  const auto count = static_cast<double>(transitions);
  return of_each * count * count / (count + 2 * (count - 1) * 0.25);
}

constexpr double kBlocks = 9;                        // of a window
constexpr double kSums = 1 / (5.0 / 9) / (5.0 / 9);  // independent sums of a window, whose windows overlap

/// Adds up each value and its two neighbours, along rows and columns; values beside the plane are those of its edge.
void sum_windows(std::span<float> plane, size_t height, size_t width) {
  parallel_for(height, 16, [&](size_t begin, size_t end) {
    std::vector<float> row(width + 2);
    for (size_t y = begin; y < end; ++y) {
      float* const values = plane.data() + y * width;
      std::copy_n(values, width, row.begin() + 1);
      row.front() = row[1];
      row.back() = row[width];
      for (size_t x = 0; x < width; ++x) values[x] = row[x] + row[x + 1] + row[x + 2];
    }
  });
  parallel_for(width, 256, [&](size_t begin, size_t end) {
    std::vector<float> above(plane.begin() + static_cast<ptrdiff_t>(begin),
                             plane.begin() + static_cast<ptrdiff_t>(end));
    for (size_t y = 0; y < height; ++y) {
      float* const values = plane.data() + y * width;
      const float* const below = y + 1 < height ? values + width : values;
      for (size_t x = begin; x < end; ++x) {
        const float value = values[x];
        values[x] += above[x - begin] + below[x];
        above[x - begin] = value;
      }
    }
  });
}

/// Sets everything within three blocks of what is set: within the reach of the windows, and where a moving thing has
/// weak texture beside what is seen to move.
void dilate(std::vector<uint8_t>& mask, size_t height, size_t width) {
  constexpr size_t kReach = 3;
  std::vector<uint8_t> across(mask.size()), row(width + 2 * kReach);
  for (size_t y = 0; y < height; ++y) {
    std::copy_n(mask.begin() + static_cast<ptrdiff_t>(y * width), width, row.begin() + kReach);
    uint8_t* const to = across.data() + y * width;
    for (size_t x = 0; x < width; ++x) to[x] = *std::max_element(&row[x], &row[x] + 2 * kReach + 1);
  }
  std::ranges::fill(mask, uint8_t{0});
  for (size_t y = 0; y < height; ++y) {
    for (size_t from = y < kReach ? 0 : y - kReach; from < std::min(height, y + kReach + 1); ++from) {
      for (size_t x = 0; x < width; ++x) mask[y * width + x] |= across[from * width + x];
    }
  }
}

size_t blocks_of(size_t pixels) {
  return (pixels + kBlock - 1) / kBlock;
}

/// Returns a count in units of fused counts, limited to their range.
int units_of(int16_t count) {
  return std::clamp<int>(count, INT16_MIN / kUnits, INT16_MAX / kUnits) * kUnits;
}

/// Returns the sum over the columns of a block of sums over its rows.
int sum_of_block(const std::vector<int>& columns, size_t block) {
  const size_t left = block * kBlock;
  return columns[left] + (left + 1 < columns.size() ? columns[left + 1] : 0);
}

}  // namespace

CycleFusion::CycleFusion(const capture::SensorProfile& camera, size_t most_cycles)
    : most_cycles_(most_cycles), reference_variance_(reference_variance(camera)) {
  E2LF_REQUIRE(most_cycles >= 1 && most_cycles <= kMostFusedCycles, "the number of fused cycles is out of range");
  const bool is_pixel = camera.is_pixel();
  threshold_on_ = is_pixel ? camera.pixel[PixelConstant::kThresholdOn] : camera.constants.tau;
  threshold_off_ = is_pixel ? camera.pixel[PixelConstant::kThresholdOff] : camera.constants.tau;
  rounding_ = is_pixel ? kRoundingOfPixels : kRounding;
  threshold_spread_ = is_pixel ? 0 : camera.constants.sigma_z / camera.constants.tau;
  for (int level = 0; level <= kMostLevel * kLevelsPerEvent; ++level) {
    variances_.push_back(level_variance(camera, threshold_on_ * static_cast<float>(level) / kLevelsPerEvent));
  }
  // The weight w of a new cycle changes the relative variance v to (1 - w)^2 v + w^2.
  double variance = 1;
  effective_ = {1, 1};
  while (effective_.size() < kSettled * most_cycles) {
    const double weight = 1 / static_cast<double>(std::min(effective_.size(), most_cycles));
    variance = (1 - weight) * (1 - weight) * variance + weight * weight;
    effective_.push_back(static_cast<float>(1 / variance));
  }
}

float CycleFusion::count_variance(int level, int count) const {
  const int at = std::max(level, 0) * kLevelsPerEvent / kUnits;
  const float threshold = count < 0 ? threshold_off_ : threshold_on_;
  const float spread = threshold_spread_ * static_cast<float>(count) / kUnits;
  return variances_[static_cast<size_t>(std::min(at, kMostLevel * kLevelsPerEvent))] / (threshold * threshold) +
         spread * spread + rounding_;
}

void CycleFusion::restart(const PlanesView<const int16_t>& cycle) {
  const auto [count, height, width] = cycle.extents;
  const size_t blocks_y = blocks_of(height), blocks_x = blocks_of(width);
  fused_.counts.resize(count, height, width);
  fused_.cycles.resize(1, height, width);
  residuals_.resize(count, blocks_y, blocks_x);
  expected_.resize(count, blocks_y, blocks_x);
  added_.assign(blocks_y * blocks_x, 0);
  of_blocks_.resize(blocks_y * blocks_x);
  of_sums_.resize(blocks_y * blocks_x);
  is_changed_.assign(blocks_y * blocks_x, 1);
}

void CycleFusion::add(const PlanesView<const int16_t>& cycle) {
  const std::array<size_t, 3> extents = {fused_.counts.count, fused_.counts.height, fused_.counts.width};
  if (cycle.extents != extents) {
    restart(cycle);
  } else if (most_cycles_ > 1) {
    compare(cycle);
    find_changes();
  }
  update(cycle);
}

void CycleFusion::compare(const PlanesView<const int16_t>& cycle) {
  parallel_for(residuals_.height, 8, [&](size_t begin, size_t end) {
    for (size_t block_y = begin; block_y < end; ++block_y) compare_row(cycle, block_y);
  });
}

void CycleFusion::compare_row(const PlanesView<const int16_t>& cycle, size_t block_y) {
  const size_t blocks_x = residuals_.width, width = fused_.counts.width, first = block_y * kBlock;
  const size_t rows = std::min(kBlock, fused_.counts.height - first);
  const uint16_t* const added = added_.data() + block_y * blocks_x;
  std::vector<int16_t> scratch;
  std::vector<int> level(blocks_x);
  std::vector<float> before(blocks_x, reference_variance_ / (threshold_on_ * threshold_on_) + rounding_);
  for (size_t k = 0; k < fused_.counts.count; ++k) {
    std::vector<int> residual(width), mean(width);  // sums over the rows of the blocks
    for (size_t y = first; y < first + rows; ++y) {
      const auto counts = cycle[k][y].values(scratch);
      const int16_t* const means = fused_.counts.image(k).data() + y * width;
      for (size_t x = 0; x < width; ++x) {
        residual[x] += units_of(counts[x]) - means[x];
        mean[x] += means[x];
      }
    }
    float* const sums = residuals_.image(k).data() + block_y * blocks_x;
    float* const expected = expected_.image(k).data() + block_y * blocks_x;
    for (size_t x = 0; x < blocks_x; ++x) {
      const auto pixels = static_cast<int>(rows * std::min(kBlock, width - x * kBlock));
      const int count = sum_of_block(mean, x) / pixels;
      level[x] += count;
      const float variance = count_variance(level[x], count);
      sums[x] = static_cast<float>(sum_of_block(residual, x)) / kUnits;
      // The noise of the level before a transition is in its count, too, and noisy thresholds are made up for.
      expected[x] = static_cast<float>(pixels) * (1 + 1 / effective_[added[x]]) * (before[x] + variance);
      before[x] = variance;
    }
  }
}

void CycleFusion::find_changes() {
  const size_t height = residuals_.height, width = residuals_.width, transitions = residuals_.count;
  std::ranges::fill(of_blocks_, 0.0F);
  std::ranges::fill(of_sums_, 0.0F);
  const auto add_squares = [&](size_t k, std::vector<float>& to) {
    const auto sums = residuals_.image(k), expected = expected_.image(k);
    for (size_t i = 0; i < to.size(); ++i) to[i] += sums[i] * sums[i] / expected[i];
  };
  for (size_t k = 0; k < transitions; ++k) {
    add_squares(k, of_blocks_);
    sum_windows(residuals_.image(k), height, width);
    sum_windows(expected_.image(k), height, width);
    add_squares(k, of_sums_);
  }
  sum_windows(of_blocks_, height, width);
  sum_windows(of_sums_, height, width);
  const float scale = static_cast<float>(kBlocks) * static_cast<float>(transitions);
  const float most_of_blocks = scale * limit_of(freedom_of(transitions, kBlocks));
  const float most_of_sums = scale * limit_of(freedom_of(transitions, kSums));
  for (size_t i = 0; i < is_changed_.size(); ++i) {
    is_changed_[i] = of_blocks_[i] > most_of_blocks || of_sums_[i] > most_of_sums;
  }
  dilate(is_changed_, height, width);
}

void CycleFusion::update(const PlanesView<const int16_t>& cycle) {
  parallel_for(blocks_of(fused_.counts.height), 8, [&](size_t begin, size_t end) {
    for (size_t block_y = begin; block_y < end; ++block_y) update_row(cycle, block_y);
  });
  const auto restarted = std::ranges::count(is_changed_, uint8_t{1});
  changed_ = static_cast<double>(restarted) / static_cast<double>(is_changed_.size());
  std::ranges::fill(is_changed_, uint8_t{0});
}

void CycleFusion::update_row(const PlanesView<const int16_t>& cycle, size_t block_y) {
  const size_t blocks_x = residuals_.width, width = fused_.counts.width, first = block_y * kBlock;
  uint16_t* const added = added_.data() + block_y * blocks_x;
  std::vector<int> weights(blocks_x * kBlock);
  for (size_t x = 0; x < blocks_x; ++x) {
    if (is_changed_[block_y * blocks_x + x] != 0) added[x] = 0;
    added[x] = static_cast<uint16_t>(std::min<size_t>(added[x] + 1U, effective_.size() - 1));
    std::fill_n(weights.begin() + static_cast<ptrdiff_t>(x * kBlock), kBlock,
                (1 << kWeightBits) / static_cast<int>(std::min<size_t>(added[x], most_cycles_)));
  }
  std::vector<int16_t> scratch;
  for (size_t y = first; y < std::min(fused_.counts.height, first + kBlock); ++y) {
    float* const cycles = fused_.cycles.values.data() + y * width;
    for (size_t x = 0; x < width; ++x) cycles[x] = effective_[added[x / kBlock]];
    for (size_t k = 0; k < fused_.counts.count; ++k) {
      const auto counts = cycle[k][y].values(scratch);
      int16_t* const means = fused_.counts.image(k).data() + y * width;
      for (size_t x = 0; x < width; ++x) {
        const int step = (units_of(counts[x]) - means[x]) * weights[x] + (1 << (kWeightBits - 1));
        means[x] = static_cast<int16_t>(means[x] + (step >> kWeightBits));
      }
    }
  }
}

}  // namespace e2lf::recon
