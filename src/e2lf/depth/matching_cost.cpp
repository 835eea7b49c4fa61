// SPDX-License-Identifier: MIT
#include "e2lf/depth/matching_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"
#include "e2lf/lightfield/refocus.h"

namespace e2lf::depth {
namespace {

using lightfield::kShiftTaps;
using lightfield::LightField;
using lightfield::Shape;
using lightfield::ShiftFilter;

constexpr size_t kBandRows = 16;

/// The sectors of views relative to the reference: 3 * row + column, where 0 is above or left, 1 level, and 2 below or
/// right.
constexpr size_t kSectors = 9;

size_t side(size_t view, size_t reference) {
  return view < reference ? 0 : view == reference ? 1 : 2;
}

/// The parts of the views: all of them, and the half planes, as sets of sectors.
constexpr std::array<std::array<bool, kSectors>, 5> kParts = {{
    {true, true, true, true, false, true, true, true, true},       // all but the reference; must be the first
    {true, false, false, true, false, false, true, false, false},  // left
    {false, false, true, false, false, true, false, false, true},  // right
    {true, true, true, false, false, false, false, false, false},  // above
    {false, false, false, false, false, false, true, true, true},  // below
}};

/// Half of the views match by chance more easily than all of them, so their cost is multiplied by this factor.
constexpr float kHalfPenalty = 1.7F;

/// Rows [begin, end) of the picture, extended by one row on each side if it exists.
struct Band {
  size_t begin, end, outer_begin, outer_end;
  [[nodiscard]] size_t outer_rows() const { return outer_end - outer_begin; }
};

class CostMaker {
 public:
  CostMaker(const LightField& light_field, const ViewIndex& reference, float most_difference)
      : light_field_(light_field), reference_(reference), most_(most_difference) {
    const Shape& shape = light_field.shape();
    for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
      for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
        ++sector_views_[3 * side(view_y, reference.y) + side(view_x, reference.x)];
      }
    }
  }

  void make_band(const Band& band, CostVolume& volume) {
    const size_t size = band.outer_rows() * volume.width;
    for (auto& sums : sectors_) sums.resize(size);
    cost_.resize(size);
    for (size_t label = 0; label < volume.labels.count; ++label) {
      sum_sectors(band, volume.labels.disparity(static_cast<float>(label)));
      take_least();
      store(band, label, volume);
    }
  }

 private:
  void sum_sectors(const Band& band, float disparity) {
    const Shape& shape = light_field_.shape();
    for (auto& sums : sectors_) std::fill(sums.begin(), sums.end(), 0.0F);
    for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
      for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
        if (view_y == reference_.y && view_x == reference_.x) continue;
        const float steps_y = static_cast<float>(view_y) - static_cast<float>(reference_.y);
        const float steps_x = static_cast<float>(view_x) - static_cast<float>(reference_.x);
        auto& sums = sectors_[3 * side(view_y, reference_.y) + side(view_x, reference_.x)];
        add_view(band, light_field_.view(view_y, view_x).data(), lightfield::make_shift_filter(disparity * steps_y),
                 lightfield::make_shift_filter(disparity * steps_x), sums.data());
      }
    }
  }

  /// Adds the differences between a shifted view and the reference.
  void add_view(const Band& band, const float* view, const ShiftFilter& vertical, const ShiftFilter& horizontal,
                float* sums) {
    const Shape& shape = light_field_.shape();
    const auto width = static_cast<ptrdiff_t>(shape.width), last_row = static_cast<ptrdiff_t>(shape.height) - 1;
    const ptrdiff_t first = std::clamp<ptrdiff_t>(horizontal.first, -width - kShiftTaps, width);
    const auto pad_left = static_cast<size_t>(std::max<ptrdiff_t>(0, -first));
    const auto pad_right = static_cast<size_t>(std::max<ptrdiff_t>(0, first + kShiftTaps - 1));
    row_.resize(pad_left + shape.width + pad_right);
    float* const middle = row_.data() + pad_left;
    const float* const reference = light_field_.view(reference_.y, reference_.x).data();
    for (size_t y = band.outer_begin; y < band.outer_end; ++y) {
      std::array<const float*, kShiftTaps> rows;
      for (int k = 0; k < kShiftTaps; ++k) {
        const ptrdiff_t row = std::clamp<ptrdiff_t>(static_cast<ptrdiff_t>(y) + vertical.first + k, 0, last_row);
        rows[k] = view + row * width;
      }
      const auto& v = vertical.taps;
      for (size_t x = 0; x < shape.width; ++x) {
        middle[x] = v[0] * rows[0][x] + v[1] * rows[1][x] + v[2] * rows[2][x] + v[3] * rows[3][x];
      }
      std::fill_n(row_.data(), pad_left, middle[0]);
      std::fill_n(middle + shape.width, pad_right, middle[shape.width - 1]);
      const float* const shifted = middle + first;
      const float* const here = reference + y * shape.width;
      float* const out = sums + (y - band.outer_begin) * shape.width;
      const auto& h = horizontal.taps;
      const float most = most_;
      for (size_t x = 0; x < shape.width; ++x) {
        const float value = h[0] * shifted[x] + h[1] * shifted[x + 1] + h[2] * shifted[x + 2] + h[3] * shifted[x + 3];
        out[x] += std::min(std::abs(value - here[x]), most);
      }
    }
  }

  /// Takes the cost of the part of the views that fits best.
  void take_least() {
    for (size_t part = 0; part < kParts.size(); ++part) {
      size_t views = 0, count = 0;
      std::array<const float*, kSectors> sums{};
      for (size_t sector = 0; sector < kSectors; ++sector) {
        if (!kParts[part][sector] || sector_views_[sector] == 0) continue;
        views += sector_views_[sector];
        sums[count++] = sectors_[sector].data();
      }
      if (views == 0) continue;
      const float scale = (part == 0 ? 1 : kHalfPenalty) / static_cast<float>(views);
      for (size_t i = 0; i < cost_.size(); ++i) {
        float sum = 0;
        for (size_t k = 0; k < count; ++k) sum += sums[k][i];
        cost_[i] = part == 0 ? scale * sum : std::min(cost_[i], scale * sum);
      }
    }
  }

  /// Stores the mean over 3x3 px, or fewer at the borders, in the volume.
  void store(const Band& band, size_t label, CostVolume& volume) {
    const size_t width = volume.width;
    const float scale = static_cast<float>(kMostCost) / most_;
    column_.resize(width);
    for (size_t y = band.begin; y < band.end; ++y) {
      const size_t top = std::max(y, band.outer_begin + 1) - 1, bottom = std::min(y + 2, band.outer_end);
      const float* rows = cost_.data() + (top - band.outer_begin) * width;
      std::copy_n(rows, width, column_.begin());
      for (size_t row = top + 1; row < bottom; ++row) {
        rows += width;
        for (size_t x = 0; x < width; ++x) column_[x] += rows[x];
      }
      int16_t* out = volume.at(y, 0) + label;
      for (size_t x = 0; x < width; ++x) {
        const size_t left = x == 0 ? 0 : x - 1, right = std::min(x + 1, width - 1);
        float sum = 0;
        for (size_t i = left; i <= right; ++i) sum += column_[i];
        const float mean = sum / static_cast<float>((right - left + 1) * (bottom - top));
        out[x * volume.labels.count] = static_cast<int16_t>(scale * mean + 0.5F);
      }
    }
  }

  const LightField& light_field_;
  ViewIndex reference_;
  float most_;
  std::array<size_t, kSectors> sector_views_{};
  std::array<std::vector<float>, kSectors> sectors_;
  std::vector<float> row_, cost_, column_;
};

}  // namespace

CostVolume matching_costs(const LightField& light_field, const ViewIndex& reference, const Labels& labels,
                          float most_difference, const ProgressFn& progress) {
  const Shape& shape = light_field.shape();
  E2LF_REQUIRE(shape.channels == 1 && shape.num_views() > 1, "a grey light field of several views");
  E2LF_REQUIRE(reference.y < shape.views_y && reference.x < shape.views_x, "the reference view must be there");
  CostVolume volume{shape.height, shape.width, labels, {}};
  volume.costs.resize(shape.height * shape.width * labels.count);
  const size_t bands = (shape.height + kBandRows - 1) / kBandRows;
  std::mutex mutex;
  size_t done = 0;
  parallel_for(bands, 1, [&](size_t begin, size_t end) {
    CostMaker maker(light_field, reference, most_difference);
    for (size_t i = begin; i < end && !stop_requested(); ++i) {
      Band band{i * kBandRows, std::min((i + 1) * kBandRows, shape.height), 0, 0};
      band.outer_begin = std::max<size_t>(band.begin, 1) - 1;
      band.outer_end = std::min(band.end + 1, shape.height);
      maker.make_band(band, volume);
      const std::lock_guard lock(mutex);
      ++done;
      if (progress) progress(done, bands);
    }
  });
  return volume;
}

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
