// SPDX-License-Identifier: MIT
#include "e2lf/depth/semi_global.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf::depth {
namespace {

/// The cost of labels out of range. Sums with it do not overflow.
constexpr int16_t kNever = 16000;

/// The costs of disparity changes between neighbouring pixels, in the units of CostVolume: a change by one disparity
/// hypothesis, as on slanted surfaces; a larger one between equally bright pixels, and at strong edges.
constexpr int16_t kOneLabel = 64, kMostJump = 640, kLeastJump = 64;
constexpr float kEdge = 0.03F;  ///< the difference in brightness that halves kMostJump

/// Extends a path from `before` to a pixel with the costs `own`, and adds it to `sum`.
int16_t step(const int16_t* own, const int16_t* before, int16_t least_before, int16_t jump, size_t count, int16_t* path,
             int16_t* sum) {
  int16_t least = kNever;
  const auto any = static_cast<int16_t>(least_before + jump);
  for (size_t i = 0; i < count; ++i) {
    const auto near = static_cast<int16_t>(std::min(before[static_cast<ptrdiff_t>(i) - 1], before[i + 1]) + kOneLabel);
    const int16_t best = std::min(std::min(before[i], near), any);
    const auto cost = static_cast<int16_t>(own[i] + best - least_before);
    path[i] = cost;
    least = std::min(least, cost);
    sum[i] = static_cast<int16_t>(sum[i] + cost);
  }
  return least;
}

/// The paths of one direction for a row of pixels.
class PathRow {
 public:
  PathRow(size_t width, size_t labels) : stride_(labels + 2), costs_(width * stride_, kNever), least_(width, 0) {}
  [[nodiscard]] int16_t* costs(size_t x) { return costs_.data() + x * stride_ + 1; }
  [[nodiscard]] int16_t& least(size_t x) { return least_[x]; }

 private:
  size_t stride_;
  std::vector<int16_t> costs_;
  std::vector<int16_t> least_;
};

/// Computes the four directions that come from the preceding pixels in reading order, or in the opposite order. Each
/// order is sequential, and the two are independent of each other.
class Pass {
 public:
  Pass(const CostVolume& volume, const lightfield::Image& picture, bool is_forward)
      : volume_(volume),
        picture_(picture),
        is_forward_(is_forward),
        along_(volume.width, volume.labels.count),
        across_(3, along_),
        across_before_(across_),
        outside_(1, volume.labels.count) {
    std::fill_n(outside_.costs(0), volume.labels.count, int16_t{0});
  }

  /// Adds the costs of all paths to `sums`.
  void run(std::vector<int16_t>& sums) {
    const ptrdiff_t back = is_forward_ ? -1 : 1;
    const size_t height = volume_.height, width = volume_.width;
    for (size_t i = 0; i < height && !stop_requested(); ++i) {
      const size_t y = is_forward_ ? i : height - 1 - i;
      for (size_t j = 0; j < width; ++j) {
        const size_t x = is_forward_ ? j : width - 1 - j;
        int16_t* const sum = sums.data() + (y * width + x) * volume_.labels.count;
        advance(along_, along_, {y, x}, 0, back, sum);
        for (ptrdiff_t side = -1; side <= 1; ++side) {
          const auto direction = static_cast<size_t>(side + 1);
          advance(across_[direction], across_before_[direction], {y, x}, back, side, sum);
        }
      }
      std::swap(across_, across_before_);
    }
  }

 private:
  struct Pixel {
    size_t y, x;
  };

  /// Extends the path that comes from the pixel at the offset (by_y, by_x), or begins one at the border.
  void advance(PathRow& now, PathRow& before, const Pixel& pixel, ptrdiff_t by_y, ptrdiff_t by_x, int16_t* sum) {
    const auto from_y = static_cast<ptrdiff_t>(pixel.y) + by_y, from_x = static_cast<ptrdiff_t>(pixel.x) + by_x;
    const int16_t* const own = volume_.at(pixel.y, pixel.x);
    const bool is_outside = from_y < 0 || from_y >= static_cast<ptrdiff_t>(volume_.height) || from_x < 0 ||
                            from_x >= static_cast<ptrdiff_t>(volume_.width);
    const Pixel from = is_outside ? pixel : Pixel{static_cast<size_t>(from_y), static_cast<size_t>(from_x)};
    PathRow& previous = is_outside ? outside_ : before;
    const size_t place = is_outside ? 0 : from.x;
    now.least(pixel.x) = step(own, previous.costs(place), previous.least(place), jump(pixel, from),
                              volume_.labels.count, now.costs(pixel.x), sum);
  }

  [[nodiscard]] int16_t jump(const Pixel& pixel, const Pixel& from) const {
    const float difference =
        std::abs(picture_.pixels[pixel.y * volume_.width + pixel.x] - picture_.pixels[from.y * volume_.width + from.x]);
    const float cost = static_cast<float>(kMostJump) / (1 + difference / kEdge);
    return std::max(kLeastJump, static_cast<int16_t>(cost));
  }

  const CostVolume& volume_;
  const lightfield::Image& picture_;
  bool is_forward_;
  PathRow along_;
  std::vector<PathRow> across_, across_before_;
  PathRow outside_;  ///< from which paths begin: no costs
};

}  // namespace

void smooth_costs(CostVolume& volume, const lightfield::Image& picture) {
  E2LF_REQUIRE(picture.width == volume.width && picture.height == volume.height && picture.channels == 1,
               "the picture is the grey reference view");
  std::vector<int16_t> forward(volume.costs.size()), backward(volume.costs.size());
  parallel_for(2, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) Pass(volume, picture, i == 0).run(i == 0 ? forward : backward);
  });
  for (size_t i = 0; i < forward.size(); ++i) volume.costs[i] = static_cast<int16_t>(forward[i] + backward[i]);
}

}  // namespace e2lf::depth
