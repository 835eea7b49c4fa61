// SPDX-License-Identifier: MIT
#include "e2lf/recon/fusion.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/fusion_kernels.h"

namespace e2lf::recon {
namespace {

constexpr size_t kCell = 4;  // px along each axis that start again together
constexpr int kUnits = capture::kFusedUnits;
/// The effective number of cycles is tabulated up to this multiple of the number of cycles in a mean. It hardly grows
/// beyond.
constexpr size_t kSettled = 8;

/// Windows in which a change is looked for: their reach around a cell in cells, and what a mean of squares exceeds
/// there as rarely as a normal variable exceeds this number of standard deviations. The second limit is for cells near
/// some that changed with the last cycle: what moves goes on moving.
struct Window {
  size_t reach;
  double deviations, deviations_near;
};
constexpr Window kWindows[] = {{1, 5, 5}, {2, 4, 3.5}};
constexpr size_t kNear = 2;      // cells
constexpr size_t kDilation = 1;  // cells around a changed one that start again, which its windows reach
/// The variance that noise makes follows the means, which change less and less: that of each cell is computed with the
/// cycles 1, 2, 4, ... since its last change, and with one of this number.
constexpr size_t kNoisePeriod = 16;

/// Returns what a chi-squared variable with `freedom` degrees of freedom, divided by them, exceeds as rarely as a
/// normal one exceeds `deviations` standard deviations (Wilson and Hilferty 1931).
float limit_of(double freedom, double deviations) {
  const double share = 2 / (9 * freedom);
  return static_cast<float>(std::pow(1 - share + deviations * std::sqrt(share), 3));
}

/// Returns the degrees of freedom of the mean of squares over the transitions, whose counts share the noise of the
/// level between them, so that the correlation of consecutive ones is -1/2; `of_each` is the number for one transition.
double freedom_of(size_t transitions, double of_each) {
  const auto count = static_cast<double>(transitions);
  return of_each * count * count / (count + 2 * (count - 1) * 0.25);
}

/// Sets `sums` to the sum of each value and those up to `reach` beside it; values beside the row are those of its ends.
void sum_row(const float* values, size_t count, size_t reach, std::vector<float>& padded, float* sums) {
  padded.resize(count + 2 * reach);
  std::fill_n(padded.begin(), reach, values[0]);
  std::copy_n(values, count, padded.begin() + static_cast<ptrdiff_t>(reach));
  std::fill_n(padded.end() - static_cast<ptrdiff_t>(reach), reach, values[count - 1]);
  std::copy_n(padded.begin(), count, sums);
  for (size_t step = 1; step <= 2 * reach; ++step) {
    for (size_t x = 0; x < count; ++x) sums[x] += padded[x + step];
  }
}

/// Returns the sums over square windows; values beside the plane are those of its edge.
std::vector<float> sum_windows(const std::vector<float>& plane, size_t height, size_t width, size_t reach) {
  std::vector<float> across(plane.size()), sums(plane.size()), padded;
  for (size_t y = 0; y < height; ++y) {
    sum_row(plane.data() + y * width, width, reach, padded, across.data() + y * width);
  }
  for (size_t y = 0; y < height; ++y) {
    float* const to = sums.data() + y * width;
    for (size_t step = 0; step <= 2 * reach; ++step) {
      const size_t from = std::min(std::max(y + step, reach) - reach, height - 1);
      for (size_t x = 0; x < width; ++x) to[x] += across[from * width + x];
    }
  }
  return sums;
}

void add_mask(const uint8_t* __restrict mask, size_t count, uint8_t* __restrict to) {
  for (size_t x = 0; x < count; ++x) to[x] |= mask[x];
}

/// Returns what is set within `reach` cells.
std::vector<uint8_t> dilated(const std::vector<uint8_t>& mask, size_t height, size_t width, size_t reach) {
  std::vector<uint8_t> across(mask.size()), result(mask.size());
  for (size_t y = 0; y < height; ++y) {
    const uint8_t* const from = mask.data() + y * width;
    uint8_t* const to = across.data() + y * width;
    for (size_t step = 0; step <= std::min(reach, width - 1); ++step) {
      add_mask(from, width - step, to + step);
      add_mask(from + step, width - step, to);
    }
  }
  for (size_t y = 0; y < height; ++y) {
    for (size_t from = y < reach ? 0 : y - reach; from < std::min(height, y + reach + 1); ++from) {
      add_mask(across.data() + from * width, width, result.data() + y * width);
    }
  }
  return result;
}

size_t cells_of(size_t pixels) {
  return (pixels + kCell - 1) / kCell;
}

}  // namespace

CycleFusion::CycleFusion(const capture::SensorProfile& camera, size_t most_cycles)
    : most_cycles_(most_cycles), noise_(camera) {
  E2LF_REQUIRE(most_cycles >= 1 && most_cycles <= kMostFusedCycles, "the number of fused cycles is out of range");
  // The weight w of a new cycle changes the relative variance v to (1 - w)^2 v + w^2.
  double variance = 1;
  effective_ = {1, 1};
  while (effective_.size() < kSettled * most_cycles) {
    const double weight = 1 / static_cast<double>(std::min(effective_.size(), most_cycles));
    variance = (1 - weight) * (1 - weight) * variance + weight * weight;
    effective_.push_back(static_cast<float>(1 / variance));
  }
}

void CycleFusion::restart(const PlanesView<const int16_t>& cycle) {
  const auto [count, height, width] = cycle.extents;
  cells_y_ = cells_of(height);
  cells_x_ = cells_of(width);
  const size_t cells = cells_y_ * cells_x_;
  cycle_ = 0;
  hidden_means_.resize(count, height, width);
  fused_.counts.resize(count, height, width);
  fused_.cycles.resize(1, height, width);
  added_.assign(cells, 0);
  unsettled_.assign(cells, 0);
  noise_of_cycle_.resize(cells);
  of_blocks_.resize(cells);
  of_cells_.resize(cells);
  expected_.resize(cells);
  is_changed_.assign(cells, 1);
  is_near_change_.assign(cells, 0);
  are_means_hidden_.assign(cells_y_, 0);
}

capture::EventImages& CycleFusion::means(size_t cell_y) {
  return are_means_hidden_[cell_y] != 0 ? hidden_means_ : fused_.counts;
}

/// Separates the means of a row of cells from what is shown there, or unites them again.
void CycleFusion::hide_means(size_t cell_y, bool are_hidden) {
  if (are_hidden == (are_means_hidden_[cell_y] != 0)) return;
  const capture::EventImages& from = means(cell_y);
  are_means_hidden_[cell_y] = are_hidden ? 1 : 0;
  capture::EventImages& to = means(cell_y);
  const size_t first = cell_y * kCell * from.width;
  const size_t count = std::min(kCell, from.height - cell_y * kCell) * from.width;
  for (size_t k = 0; k < from.count; ++k) {
    std::ranges::copy(from.image(k).subspan(first, count), to.image(k).subspan(first).begin());
  }
}

void CycleFusion::add(const PlanesView<const int16_t>& cycle) {
  const std::array<size_t, 3> extents = {fused_.counts.count, fused_.counts.height, fused_.counts.width};
  const bool is_first = cycle.extents != extents;
  if (is_first) {
    restart(cycle);
  } else if (most_cycles_ > 1) {
    compare(cycle);
    find_changes();
  }
  update(cycle);
  if (!is_first) is_near_change_ = dilated(is_changed_, cells_y_, cells_x_, kNear);
  std::ranges::fill(is_changed_, uint8_t{0});
  ++cycle_;
}

void CycleFusion::compare(const PlanesView<const int16_t>& cycle) {
  parallel_for(cells_y_, 8, [&](size_t begin, size_t end) {
    for (size_t cell_y = begin; cell_y < end; ++cell_y) compare_row(cycle, cell_y);
  });
}

void CycleFusion::compare_row(const PlanesView<const int16_t>& cycle, size_t cell_y) {
  const capture::EventImages& all_means = means(cell_y);
  const size_t width = all_means.width, first = cell_y * kCell;
  const size_t rows = std::min(kCell, all_means.height - first), begin = cell_y * cells_x_;
  std::fill_n(of_blocks_.begin() + static_cast<ptrdiff_t>(begin), cells_x_, 0.0F);
  std::fill_n(of_cells_.begin() + static_cast<ptrdiff_t>(begin), cells_x_, 0.0F);
  constexpr size_t kBlocks = kCell / kBlock;  // of a cell along each axis
  std::vector<int16_t> scratch;
  std::vector<float> sums(cells_x_);
  std::vector<int32_t> residuals(cells_x_ * kBlocks);  // sums over blocks; those of pixels beside the image are 0
  for (size_t k = 0; k < all_means.count; ++k) {
    std::ranges::fill(sums, 0.0F);
    for (size_t y = first; y < first + rows; ++y) {
      if ((y - first) % kBlock == 0) std::ranges::fill(residuals, 0);
      add_residuals(cycle[k][y].values(scratch).data(), all_means.image(k).data() + y * width, width, residuals.data());
      if ((y - first) % kBlock + 1 < kBlock && y + 1 < first + rows) continue;
      for (size_t x = 0; x < cells_x_; ++x) {
        const auto left = static_cast<float>(residuals[kBlocks * x]),
                   right = static_cast<float>(residuals[kBlocks * x + 1]);
        of_blocks_[begin + x] += left * left + right * right;
        sums[x] += left + right;
      }
    }
    for (size_t x = 0; x < cells_x_; ++x) of_cells_[begin + x] += sums[x] * sums[x];
  }
  expect_noise(cell_y);
}

/// Sets what noise makes of the residuals of a row of cells.
void CycleFusion::expect_noise(size_t cell_y) {
  const capture::EventImages& all_means = means(cell_y);
  const size_t width = all_means.width, first = cell_y * kCell, rows = std::min(kCell, all_means.height - first);
  for (size_t x = 0; x < cells_x_; ++x) {
    const size_t cell = cell_y * cells_x_ + x, left = x * kCell, columns = std::min(kCell, width - left);
    if (std::has_single_bit(added_[cell]) || (cycle_ + x) % kNoisePeriod == 0) {
      const size_t pixels = rows * columns;
      CountNoise::PixelLevel level;
      noise_of_cycle_[cell] = 0;
      for (size_t k = 0; k < all_means.count; ++k) {
        int sum = 0;
        for (size_t y = first; y < first + rows; ++y) {
          const int16_t* const means = all_means.image(k).data() + y * width + left;
          for (size_t column = 0; column < columns; ++column) sum += means[column];
        }
        const float count = static_cast<float>(sum) / static_cast<float>(pixels * kUnits);
        noise_of_cycle_[cell] += static_cast<float>(pixels) * noise_.next(count, level);
      }
    }
    constexpr auto kSquaredUnits = static_cast<float>(kUnits * kUnits);
    expected_[cell] = noise_of_cycle_[cell] * kSquaredUnits * (1 + 1 / effective_[added_[cell]]);
  }
}

void CycleFusion::find_changes() {
  const size_t transitions = fused_.counts.count;
  constexpr size_t kBlocks = kCell * kCell / kBlock / kBlock;  // of a cell
  for (const Window& window : kWindows) {
    const auto sum = [&](const std::vector<float>& plane) {
      return sum_windows(plane, cells_y_, cells_x_, window.reach);
    };
    const std::vector<float> blocks = sum(of_blocks_), cells = sum(of_cells_), expected = sum(expected_);
    const auto side = static_cast<double>(2 * window.reach + 1);
    const double of_cells = freedom_of(transitions, side * side), of_blocks = kBlocks * of_cells;
    const float limits[2][2] = {
        {limit_of(of_blocks, window.deviations), limit_of(of_cells, window.deviations)},
        {limit_of(of_blocks, window.deviations_near), limit_of(of_cells, window.deviations_near)}};
    for (size_t i = 0; i < is_changed_.size(); ++i) {
      const float* const limit = limits[is_near_change_[i]];
      is_changed_[i] |= blocks[i] > limit[0] * expected[i] || cells[i] > limit[1] * expected[i];
    }
  }
  is_changed_ = dilated(is_changed_, cells_y_, cells_x_, kDilation);
}

void CycleFusion::update(const PlanesView<const int16_t>& cycle) {
  parallel_for(cells_y_, 8, [&](size_t begin, size_t end) {
    for (size_t cell_y = begin; cell_y < end; ++cell_y) update_row(cycle, cell_y);
  });
  const auto restarted = std::ranges::count(is_changed_, uint8_t{1});
  changed_ = static_cast<double>(restarted) / static_cast<double>(is_changed_.size());
}

/// Adds a cycle to a cell, which starts again if it has changed.
void CycleFusion::count_cycle(size_t cell) {
  if (is_changed_[cell] != 0) {
    unsettled_[cell] = added_[cell] > 0 ? kUnsettledCycles : 0;  // the first cycle is no change
    added_[cell] = 0;
  } else if (unsettled_[cell] > 0) {
    --unsettled_[cell];
  }
  added_[cell] = static_cast<uint16_t>(std::min<size_t>(added_[cell] + 1U, effective_.size() - 1));
}

void CycleFusion::update_row(const PlanesView<const int16_t>& cycle, size_t cell_y) {
  const size_t width = fused_.counts.width, first = cell_y * kCell;
  std::vector<int32_t> weights(cells_x_ * kCell);
  std::vector<float> numbers(cells_x_ * kCell);
  std::vector<uint8_t> is_alone(cells_x_ * kCell);
  for (size_t x = 0; x < cells_x_; ++x) {
    const size_t cell = cell_y * cells_x_ + x;
    count_cycle(cell);
    const bool is_settled = unsettled_[cell] == 0;
    const auto at = static_cast<ptrdiff_t>(x * kCell);
    std::fill_n(weights.begin() + at, kCell,
                (1 << kMeanWeightBits) / static_cast<int>(std::min<size_t>(added_[cell], most_cycles_)));
    std::fill_n(numbers.begin() + at, kCell, is_settled ? effective_[added_[cell]] : 1.0F);
    std::fill_n(is_alone.begin() + at, kCell, is_settled ? 0 : 1);
  }
  hide_means(cell_y, std::ranges::count(is_alone, uint8_t{1}) > 0);
  std::vector<int16_t> scratch;
  float* const shown_numbers = fused_.cycles.values.data() + first * width;
  const bool has_other_numbers = !std::equal(shown_numbers, shown_numbers + width, numbers.begin());
  for (size_t y = first; y < std::min(fused_.counts.height, first + kCell); ++y) {
    if (has_other_numbers) std::copy_n(numbers.begin(), width, shown_numbers + (y - first) * width);
    for (size_t k = 0; k < fused_.counts.count; ++k) {
      const auto counts = cycle[k][y].values(scratch);
      int16_t* const mean = means(cell_y).image(k).data() + y * width;
      add_to_means(counts.data(), weights.data(), width, mean);
      if (are_means_hidden_[cell_y] == 0) continue;
      int16_t* const shown = fused_.counts.image(k).data() + y * width;
      for (size_t x = 0; x < width; ++x) {
        shown[x] = is_alone[x] != 0 ? static_cast<int16_t>(units_of(counts[x])) : mean[x];
      }
    }
  }
}

}  // namespace e2lf::recon
