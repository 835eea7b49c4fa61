// SPDX-License-Identifier: MIT
#include "e2lf/depth/semi_global.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/contract.h"
#include "e2lf/base/threads.h"

namespace e2lf::depth {
namespace {

/// Beyond the labels; sums with it do not overflow.
constexpr int16_t kNever = 16000;

/// Continues a path from `before` to a pixel with these own costs; adds it to `sum`.
int16_t step(const int16_t* own, const int16_t* before, int16_t least_before, int16_t one_label, int16_t jump,
             size_t count, int16_t* path, int16_t* sum) {
  int16_t least = kNever;
  const auto any = static_cast<int16_t>(least_before + jump);
  for (size_t i = 0; i < count; ++i) {
    const auto near = static_cast<int16_t>(std::min(before[static_cast<ptrdiff_t>(i) - 1], before[i + 1]) + one_label);
    const int16_t best = std::min(std::min(before[i], near), any);
    const auto cost = static_cast<int16_t>(own[i] + best - least_before);
    path[i] = cost;
    least = std::min(least, cost);
    sum[i] = static_cast<int16_t>(sum[i] + cost);
  }
  return least;
}

/// Paths of one direction for a row of pixels.
class PathRow {
 public:
  PathRow(size_t width, size_t labels)
      : stride_(labels + 2), costs_(width * stride_, kNever), least_(width, 0), labels_(labels) {}
  [[nodiscard]] int16_t* costs(size_t x) { return costs_.data() + x * stride_ + 1; }
  [[nodiscard]] int16_t& least(size_t x) { return least_[x]; }
  void begin(size_t x, const int16_t* own, int16_t* sum) {
    int16_t least = kNever;
    int16_t* const path = costs(x);
    for (size_t i = 0; i < labels_; ++i) {
      path[i] = own[i];
      least = std::min(least, own[i]);
      sum[i] = static_cast<int16_t>(sum[i] + own[i]);
    }
    least_[x] = least;
  }

 private:
  size_t stride_;
  std::vector<int16_t> costs_;
  std::vector<int16_t> least_;
  size_t labels_;
};

class Smoother {
 public:
  Smoother(const CostVolume& volume, const lightfield::Image& picture, const ChangeCosts& change,
           std::vector<int16_t>& sums)
      : volume_(volume), picture_(picture), change_(change), sums_(sums) {}

  void along_rows() {
    parallel_for(volume_.height, 4, [&](size_t begin, size_t end) {
      PathRow row(volume_.width, volume_.labels.count);
      for (size_t y = begin; y < end; ++y) {
        for (size_t x = 0; x < volume_.width; ++x) advance(row, y, x, row, y, static_cast<ptrdiff_t>(x) - 1);
        for (size_t x = volume_.width; x-- > 0;) advance(row, y, x, row, y, static_cast<ptrdiff_t>(x) + 1);
      }
    });
  }

  /// Three directions at once: down (or up) and both diagonals.
  void across_rows(bool downwards) {
    std::vector<PathRow> now(3, PathRow(volume_.width, volume_.labels.count)), before = now;
    for (size_t i = 0; i < volume_.height; ++i) {
      const size_t y = downwards ? i : volume_.height - 1 - i;
      const size_t from_y = i == 0 ? y : downwards ? y - 1 : y + 1;
      parallel_for(volume_.width, 64, [&](size_t begin, size_t end) {
        for (size_t x = begin; x < end; ++x) {
          for (ptrdiff_t side = -1; side <= 1; ++side) {
            const ptrdiff_t from_x = i == 0 ? -1 : static_cast<ptrdiff_t>(x) + side;
            advance(now[static_cast<size_t>(side + 1)], y, x, before[static_cast<size_t>(side + 1)], from_y, from_x);
          }
        }
      });
      std::swap(now, before);
    }
  }

 private:
  void advance(PathRow& now, size_t y, size_t x, PathRow& before, size_t from_y, ptrdiff_t from_x) {
    const int16_t* const own = volume_.at(y, x);
    int16_t* const sum = sums_.data() + (y * volume_.width + x) * volume_.labels.count;
    if (from_x < 0 || from_x >= static_cast<ptrdiff_t>(volume_.width)) return now.begin(x, own, sum);
    const auto from = static_cast<size_t>(from_x);
    now.least(x) = step(own, before.costs(from), before.least(from), change_.one_label, jump(y, x, from_y, from),
                        volume_.labels.count, now.costs(x), sum);
  }

  [[nodiscard]] int16_t jump(size_t y, size_t x, size_t from_y, size_t from_x) const {
    const float difference =
        std::abs(picture_.pixels[y * volume_.width + x] - picture_.pixels[from_y * volume_.width + from_x]);
    const float cost = static_cast<float>(change_.most) / (1 + difference / change_.edge);
    return std::max(change_.least, static_cast<int16_t>(cost));
  }

  const CostVolume& volume_;
  const lightfield::Image& picture_;
  const ChangeCosts& change_;
  std::vector<int16_t>& sums_;
};

}  // namespace

void smooth_costs(CostVolume& volume, const lightfield::Image& picture, const ChangeCosts& change) {
  E2LF_REQUIRE(picture.width == volume.width && picture.height == volume.height && picture.channels == 1,
               "the picture is the grey reference view");
  std::vector<int16_t> sums(volume.costs.size());
  Smoother smoother(volume, picture, change, sums);
  smoother.along_rows();
  smoother.across_rows(true);
  smoother.across_rows(false);
  volume.costs = std::move(sums);
}

}  // namespace e2lf::depth
