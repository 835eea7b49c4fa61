// SPDX-License-Identifier: MIT
#include "e2lf/live/live_cycle.h"

#include "e2lf/base/result.h"

namespace e2lf::live {
namespace {

/// Sums `kSide` neighbouring columns each. The side is known to the compiler, which can then vectorise the loop.
template <size_t kSide, typename Convert>
void sum_columns(const std::vector<int>& columns, size_t width, const Convert& convert, int16_t* to) {
  for (size_t x = 0; x < width; ++x) {
    int sum = 0;
    for (size_t i = 0; i < kSide; ++i) sum += columns[x * kSide + i];
    to[x] = convert(sum);
  }
}

/// Computes images of a lower resolution from the sums over blocks.
template <typename Convert>
void sum_blocks_of(const capture::EventImages& images, size_t side, capture::EventImages& sums,
                   const Convert& convert) {
  const size_t height = images.height / side, width = images.width / side;
  E2LF_REQUIRE(side == 2 || side == 4, "a picture has half or a quarter of the size");
  E2LF_REQUIRE(height > 0 && width > 0, "the sums of blocks need a block");
  if (sums.count != images.count || sums.height != height || sums.width != width) {
    sums = capture::EventImages(images.count, height, width);
  }
  std::vector<int> column(images.width);
  int16_t* to = sums.values.data();
  for (size_t row = 0; row < images.count * height; ++row) {
    const int16_t* from = images.image(row / height).data() + row % height * side * images.width;
    std::fill(column.begin(), column.end(), 0);
    for (size_t y = 0; y < side; ++y, from += images.width) {
      for (size_t x = 0; x < images.width; ++x) column[x] += from[x];
    }
    side == 2 ? sum_columns<2>(column, width, convert, to) : sum_columns<4>(column, width, convert, to);
    to += width;
  }
}

}  // namespace

void sum_blocks(const capture::EventImages& images, size_t side, capture::EventImages& sums) {
  sum_blocks_of(images, side, sums, capture::saturated);
}

void fuse_blocks(const capture::FusedCycles& fused, size_t side, capture::FusedCycles& blocks) {
  sum_blocks_of(fused.counts, side, blocks.counts, [side](int sum) {
    const auto pixels = static_cast<int>(side * side);
    return static_cast<int16_t>((sum + (sum < 0 ? -pixels : pixels) / 2) / pixels);
  });
  // The variance of a mean over pixels is that of one divided by the square of their number, summed.
  const size_t height = blocks.counts.height, width = blocks.counts.width;
  blocks.cycles.resize(1, height, width);
  const auto pixels = static_cast<float>(side * side);
  for (size_t y = 0; y < height; ++y) {
    float* const to = blocks.cycles.values.data() + y * width;
    std::fill_n(to, width, 0.0F);
    for (size_t row = y * side; row < (y + 1) * side; ++row) {
      const float* const from = fused.cycles.values.data() + row * fused.cycles.width;
      for (size_t x = 0; x < width * side; ++x) to[x / side] += 1 / from[x];
    }
    for (size_t x = 0; x < width; ++x) to[x] = pixels * pixels / to[x];
  }
}

size_t CycleSum::add(capture::EventImages& images, size_t wanted) {
  E2LF_REQUIRE(wanted >= 1 && wanted <= kMostCycles, "the number of summed cycles must be from 1 to kMostCycles");
  if (wanted == 1 || sum_.size() != images.values.size()) {
    last_.clear();
    sum_.clear();
  }
  if (wanted == 1) return 1;
  sum_.resize(images.values.size());
  const auto apply = [this](const capture::EventImages& of, int sign) {
    for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += sign * of.values[i];
  };
  for (; last_.size() >= wanted; last_.pop_front()) apply(last_.front(), -1);
  apply(images, 1);
  last_.push_back(images);
  for (size_t i = 0; i < sum_.size(); ++i) images.values[i] = capture::saturated(sum_[i]);
  return last_.size();
}

lightfield::LightField enlarged(const lightfield::LightField& light_field, size_t height, size_t width) {
  const lightfield::Shape& small = light_field.shape();
  E2LF_REQUIRE(small.height > 0 && small.width > 0 && small.channels == 1, "a grey light field with pixels");
  const size_t side = std::max<size_t>(1, std::min(height / small.height, width / small.width));
  lightfield::LightField result({small.views_y, small.views_x, height, width, 1});
  for (size_t view = 0; view < small.num_views(); ++view) {
    const size_t row = view / small.views_x, column = view % small.views_x;
    const std::span<const float> from = light_field.view(row, column);
    const std::span<float> to = result.view(row, column);
    for (size_t y = 0; y < height; ++y) {
      const size_t from_y = std::min(y / side, small.height - 1);
      for (size_t x = 0; x < width; ++x) {
        to[y * width + x] = from[from_y * small.width + std::min(x / side, small.width - 1)];
      }
    }
  }
  return result;
}

}  // namespace e2lf::live
