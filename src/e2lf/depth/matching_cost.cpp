// SPDX-License-Identifier: MIT
#include "e2lf/depth/matching_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "e2lf/base/progress.h"
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

/// Counts finished bands, from any thread.
class Progress {
 public:
  Progress(size_t total, const ProgressFn& report) : total_(total), report_(report) {}
  void count() {
    const std::lock_guard lock(mutex_);
    ++done_;
    if (report_) report_(done_, total_);
  }

 private:
  size_t total_, done_ = 0;
  const ProgressFn& report_;
  std::mutex mutex_;
};

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
  Progress done(bands, progress);
  parallel_for(bands, 1, [&](size_t begin, size_t end) {
    CostMaker maker(light_field, reference, most_difference);
    for (size_t i = begin; i < end && !stop_requested(); ++i) {
      Band band{i * kBandRows, std::min((i + 1) * kBandRows, shape.height), 0, 0};
      band.outer_begin = std::max<size_t>(band.begin, 1) - 1;
      band.outer_end = std::min(band.end + 1, shape.height);
      maker.make_band(band, volume);
      done.count();
    }
  });
  return volume;
}

}  // namespace e2lf::depth
