// SPDX-License-Identifier: MIT
#include "e2lf/recon/fusion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/fusion_kernels.h"

namespace e2lf::recon {
namespace {

constexpr size_t kCell = 4;  // px along each axis that start again together
constexpr size_t kBlocksOfCell = kCell * kCell / kBlock / kBlock;
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
constexpr std::array<Window, 2> kWindows = {{{1, 5, 5}, {2, 4, 3.5}}};
constexpr size_t kReach = kWindows.back().reach;  // of the largest window, in cells
constexpr size_t kMostRows = 2 * kReach + 1;      // that are summed
constexpr size_t kNear = 2;                       // cells
constexpr size_t kDilation = 1;  // cells around a changed one that start again, which its windows reach
/// Rows of cells that are compared and updated in turn, so that the counts and means are still in the cache.
constexpr size_t kRowsInTurn = 8;
/// The variance that noise makes follows the means, which change less and less: that of each cell is computed with the
/// cycles 1, 2, 4, ... below this number since its last change, and with one of this number.
constexpr size_t kNoisePeriod = 32;

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
void sum_beside(const float* values, size_t count, size_t reach, std::vector<float>& padded, float* sums) {
  padded.resize(count + 2 * reach);
  std::fill_n(padded.begin(), reach, values[0]);
  std::copy_n(values, count, padded.begin() + static_cast<ptrdiff_t>(reach));
  std::fill_n(padded.end() - static_cast<ptrdiff_t>(reach), reach, values[count - 1]);
  std::array<const float*, kMostRows> shifted{};
  for (size_t step = 0; step <= 2 * reach; ++step) shifted[step] = padded.data() + step;
  sum_rows(std::span(shifted).first(2 * reach + 1), count, sums);
}

/// Sets `sums` to those of the rows within `reach` of row y; rows beside the plane are those of its edge.
void sum_around(const std::vector<float>& plane, size_t height, size_t y, size_t reach, std::vector<float>& sums) {
  std::array<const float*, kMostRows> rows{};
  for (size_t step = 0; step <= 2 * reach; ++step) {
    const size_t from = std::min(std::max(y + step, reach) - reach, height - 1);
    rows[step] = plane.data() + from * sums.size();
  }
  sum_rows(std::span(rows).first(2 * reach + 1), sums.size(), sums.data());
}

void add_mask(const uint8_t* __restrict mask, size_t count, uint8_t* __restrict to) {
  for (size_t x = 0; x < count; ++x) to[x] |= mask[x];
}

/// Sets row y of `to` to what is set in the mask within `reach` cells.
void dilate_row(const std::vector<uint8_t>& mask, size_t height, size_t y, size_t reach, std::vector<uint8_t>& to) {
  const size_t width = mask.size() / height;
  std::vector<uint8_t> across(width);
  for (size_t from = y < reach ? 0 : y - reach; from < std::min(height, y + reach + 1); ++from) {
    add_mask(mask.data() + from * width, width, across.data());
  }
  uint8_t* const row = to.data() + y * width;
  std::fill_n(row, width, uint8_t{0});
  for (size_t step = 0; step <= std::min(reach, width - 1); ++step) {
    add_mask(across.data(), width - step, row + step);
    add_mask(across.data() + step, width - step, row);
  }
}

using Limits = std::array<std::array<float, 2>, 2>;

/// Sets where sums over windows exceed one of the limits, multiplied by what noise makes of them.
void exceed(const float* __restrict blocks, const float* __restrict cells, const float* __restrict expected,
            const Limits& limits, const uint8_t* __restrict is_near, size_t count, uint8_t* __restrict is_found) {
  const auto [far, near] = limits;
  for (size_t x = 0; x < count; ++x) {
    const float of_blocks = is_near[x] != 0 ? near[0] : far[0], of_cells = is_near[x] != 0 ? near[1] : far[1];
    is_found[x] |= (blocks[x] > of_blocks * expected[x]) | (cells[x] > of_cells * expected[x]);
  }
}

/// Adds a cycle to cells, of which those that have changed start again.
void count_cycle(const uint8_t* __restrict is_changed, uint16_t most, size_t cells, uint16_t* __restrict added,
                 uint8_t* __restrict unsettled) {
  for (size_t x = 0; x < cells; ++x) {
    const bool was_empty = added[x] == 0;  // the first cycle is no change
    const auto settling = static_cast<uint8_t>(unsettled[x] - (unsettled[x] > 0 ? 1 : 0));
    const uint8_t restarted = was_empty ? 0 : kUnsettledCycles;
    unsettled[x] = is_changed[x] != 0 ? restarted : settling;
    const auto before = static_cast<uint16_t>(is_changed[x] != 0 ? 0 : added[x]);
    added[x] = std::min(static_cast<uint16_t>(before + 1), most);
  }
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
  effective_ = {0, 1};
  weights_ = {0, mean_weight(1)};
  noise_of_residual_ = {2, 2};
  while (effective_.size() < kSettled * most_cycles) {
    const size_t cycles = std::min(effective_.size(), most_cycles);
    const double weight = 1 / static_cast<double>(cycles);
    variance = (1 - weight) * (1 - weight) * variance + weight * weight;
    weights_.push_back(mean_weight(cycles));
    effective_.push_back(static_cast<float>(1 / variance));
    noise_of_residual_.push_back(1 + 1 / effective_.back());
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
  for (size_t i = 0; i < kWindows.size(); ++i) {
    WindowEvidence& evidence = evidence_[i];
    for (std::vector<float>* plane : {&evidence.blocks, &evidence.cells, &evidence.expected}) plane->resize(cells);
    const Window& window = kWindows[i];
    const auto side = static_cast<double>(2 * window.reach + 1);
    const double of_cells = freedom_of(count, side * side), of_blocks = kBlocksOfCell * of_cells;
    for (size_t near = 0; near < 2; ++near) {
      const double deviations = near == 0 ? window.deviations : window.deviations_near;
      evidence.limits[near] = {limit_of(of_blocks, deviations), limit_of(of_cells, deviations)};
    }
  }
  is_found_.assign(cells, 0);
  is_changed_.assign(cells, 1);
  is_near_change_.assign(cells, 0);
}

/// Calls body(left, count) for the pixels of each run of cells of a row that show the newest cycle alone.
template <class Body>
void CycleFusion::for_runs_alone(size_t cell_y, const Body& body) const {
  const auto begin = unsettled_.begin() + static_cast<ptrdiff_t>(cell_y * cells_x_);
  const auto end = begin + static_cast<ptrdiff_t>(cells_x_);
  const auto is_alone = [](uint8_t cycles) { return cycles > 0; };
  for (auto first = std::find_if(begin, end, is_alone); first != end;) {
    const auto last = std::find_if_not(first, end, is_alone);
    const size_t left = static_cast<size_t>(first - begin) * kCell, right = static_cast<size_t>(last - begin) * kCell;
    body(left, std::min(right, fused_.counts.width) - left);
    first = std::find_if(last, end, is_alone);
  }
}

/// Replaces what a row of cells shows by its means.
void CycleFusion::restore_means(size_t cell_y) {
  capture::EventImages& counts = fused_.counts;
  const size_t first = cell_y * kCell, end = std::min(counts.height, first + kCell);
  for_runs_alone(cell_y, [&](size_t left, size_t count) {
    for (size_t k = 0; k < counts.count; ++k) {
      for (size_t y = first; y < end; ++y) {
        const size_t at = y * counts.width + left;
        std::ranges::copy(hidden_means_.image(k).subspan(at, count), counts.image(k).subspan(at).begin());
      }
    }
  });
}

void CycleFusion::add(const PlanesView<const int16_t>& cycle) {
  const std::array<size_t, 3> extents = {fused_.counts.count, fused_.counts.height, fused_.counts.width};
  const bool is_first = cycle.extents != extents, is_compared = !is_first && most_cycles_ > 1;
  if (is_first) restart(cycle);
  const auto for_rows = [](size_t begin, size_t end, const auto& body) {
    parallel_for(end - begin, 4, [&](size_t from, size_t to) {
      for (size_t cell_y = begin + from; cell_y < begin + to; ++cell_y) body(cell_y);
    });
  };
  size_t compared = 0, found = 0;
  for (size_t updated = 0; updated < cells_y_;) {
    const size_t end = std::min(updated + kRowsInTurn, cells_y_);
    if (is_compared) {
      const size_t to_find = std::min(end + kDilation, cells_y_), to_compare = std::min(to_find + kReach, cells_y_);
      for_rows(compared, to_compare, [&](size_t cell_y) { compare_row(cycle, cell_y); });
      for (; found < to_find; ++found) find_changes(found);
      for (size_t cell_y = updated; cell_y < end; ++cell_y) {
        dilate_row(is_found_, cells_y_, cell_y, kDilation, is_changed_);
      }
      compared = to_compare;
    }
    for_rows(updated, end, [&](size_t cell_y) { update_row(cycle, cell_y); });
    updated = end;
  }
  const auto restarted = std::ranges::count(is_changed_, uint8_t{1});
  changed_ = static_cast<double>(restarted) / static_cast<double>(is_changed_.size());
  for (size_t cell_y = 0; is_compared && cell_y < cells_y_; ++cell_y) {
    dilate_row(is_changed_, cells_y_, cell_y, kNear, is_near_change_);
  }
  if (is_first) std::ranges::fill(is_changed_, uint8_t{0});
  ++cycle_;
}

/// Sets the evidence of a row of cells: sums over the columns of each window.
void CycleFusion::compare_row(const PlanesView<const int16_t>& cycle, size_t cell_y) {
  restore_means(cell_y);
  const capture::EventImages& all_means = fused_.counts;
  const size_t width = all_means.width, first = cell_y * kCell, rows = std::min(kCell, all_means.height - first);
  std::array<std::vector<int16_t>, kBlock> scratch;
  const std::vector<int16_t> zeros(width);  // the rows of a block below the image
  std::vector<float> of_blocks(cells_x_), of_cells(cells_x_), sums(cells_x_);
  std::vector<int32_t> residuals(cells_x_ * 2);  // sums over blocks; those of blocks beside the image are 0
  for (size_t k = 0; k < all_means.count; ++k) {
    std::ranges::fill(sums, 0.0F);
    for (size_t y = first; y < first + rows; y += kBlock) {
      TwoRows counts = {zeros.data(), zeros.data()}, means = counts;
      for (size_t row = 0; row < std::min(kBlock, first + rows - y); ++row) {
        counts[row] = cycle[k][y + row].values(scratch[row]).data();
        means[row] = all_means.image(k).data() + (y + row) * width;
      }
      block_residuals(counts, means, width, residuals.data());
      add_squares(residuals.data(), cells_x_, of_blocks.data(), sums.data());
    }
    for (size_t x = 0; x < cells_x_; ++x) of_cells[x] += sums[x] * sums[x];
  }
  const std::vector<float> expected = expected_noise(cell_y);
  std::vector<float> padded;
  for (size_t i = 0; i < kWindows.size(); ++i) {
    const auto sum = [&](const std::vector<float>& values, std::vector<float>& to) {
      sum_beside(values.data(), cells_x_, kWindows[i].reach, padded, to.data() + cell_y * cells_x_);
    };
    sum(of_blocks, evidence_[i].blocks);
    sum(of_cells, evidence_[i].cells);
    sum(expected, evidence_[i].expected);
  }
}

/// Returns what noise makes of the squared residuals of a row of cells.
std::vector<float> CycleFusion::expected_noise(size_t cell_y) {
  const size_t begin = cell_y * cells_x_;
  for (size_t x = 0; x < cells_x_; ++x) {
    const unsigned added = added_[begin + x];
    const bool is_due = added < kNoisePeriod && (added & (added - 1)) == 0;
    if (is_due || (cycle_ + x) % kNoisePeriod == 0) noise_of_cycle_[begin + x] = noise_of_cell(cell_y, x);
  }
  std::vector<float> expected(cells_x_);
  constexpr auto kSquaredUnits = static_cast<float>(kUnits * kUnits);
  for (size_t x = 0; x < cells_x_; ++x) {
    expected[x] = noise_of_cycle_[begin + x] * kSquaredUnits * noise_of_residual_[added_[begin + x]];
  }
  return expected;
}

/// Returns the variance of the sum of the counts of a cell in one cycle, summed over the transitions.
float CycleFusion::noise_of_cell(size_t cell_y, size_t cell_x) {
  const capture::EventImages& all_means = fused_.counts;
  const size_t width = all_means.width, first = cell_y * kCell, left = cell_x * kCell;
  const size_t rows = std::min(kCell, all_means.height - first), columns = std::min(kCell, width - left);
  const size_t pixels = rows * columns;
  CountNoise::PixelLevel level;
  float noise = 0;
  for (size_t k = 0; k < all_means.count; ++k) {
    int sum = 0;
    for (size_t y = first; y < first + rows; ++y) {
      const int16_t* const means = all_means.image(k).data() + y * width + left;
      for (size_t column = 0; column < columns; ++column) sum += means[column];
    }
    const float count = static_cast<float>(sum) / static_cast<float>(pixels * kUnits);
    noise += static_cast<float>(pixels) * noise_.next(count, level);
  }
  return noise;
}

/// Finds the cells of a row where the residuals exceed what noise makes of them in one of the windows.
void CycleFusion::find_changes(size_t cell_y) {
  uint8_t* const is_found = is_found_.data() + cell_y * cells_x_;
  const uint8_t* const is_near = is_near_change_.data() + cell_y * cells_x_;
  std::fill_n(is_found, cells_x_, uint8_t{0});
  std::vector<float> blocks(cells_x_), cells(cells_x_), expected(cells_x_);
  for (size_t i = 0; i < kWindows.size(); ++i) {
    const WindowEvidence& evidence = evidence_[i];
    sum_around(evidence.blocks, cells_y_, cell_y, kWindows[i].reach, blocks);
    sum_around(evidence.cells, cells_y_, cell_y, kWindows[i].reach, cells);
    sum_around(evidence.expected, cells_y_, cell_y, kWindows[i].reach, expected);
    exceed(blocks.data(), cells.data(), expected.data(), evidence.limits, is_near, cells_x_, is_found);
  }
}

void CycleFusion::update_row(const PlanesView<const int16_t>& cycle, size_t cell_y) {
  const size_t width = fused_.counts.width, first = cell_y * kCell;
  const size_t end = std::min(fused_.counts.height, first + kCell);
  const size_t cells = cells_x_, begin = cell_y * cells;
  uint16_t* const added = added_.data() + begin;
  uint8_t* const unsettled = unsettled_.data() + begin;
  const auto most = static_cast<uint16_t>(effective_.size() - 1);
  count_cycle(is_changed_.data() + begin, most, cells, added, unsettled);
  std::vector<int16_t> weights(cells * kCell);
  std::vector<float> numbers(cells * kCell);
  for (size_t x = 0; x < cells; ++x) {
    std::fill_n(weights.data() + x * kCell, kCell, weights_[added[x]]);
    std::fill_n(numbers.data() + x * kCell, kCell, unsettled[x] == 0 ? effective_[added[x]] : 1.0F);
  }
  float* const numbers_shown = fused_.cycles.values.data();
  if (!std::equal(numbers.data(), numbers.data() + width, numbers_shown + first * width)) {
    for (size_t y = first; y < end; ++y) std::copy_n(numbers.data(), width, numbers_shown + y * width);
  }
  std::vector<int16_t> scratch;
  const auto means = [&](size_t k, size_t y) { return fused_.counts.image(k).subspan(y * width, width); };
  for (size_t k = 0; k < fused_.counts.count; ++k) {
    for (size_t y = first; y < end; ++y) {
      add_to_means(cycle[k][y].values(scratch).data(), weights.data(), width, means(k, y).data());
    }
  }
  for_runs_alone(cell_y, [&](size_t left, size_t count) {
    for (size_t k = 0; k < fused_.counts.count; ++k) {
      for (size_t y = first; y < end; ++y) {
        const auto shown = means(k, y).subspan(left, count);
        std::ranges::copy(shown, hidden_means_.image(k).subspan(y * width + left).begin());
        std::ranges::transform(cycle[k][y].values(scratch).subspan(left, count), shown.begin(), units_of);
      }
    }
  });
}

}  // namespace e2lf::recon
