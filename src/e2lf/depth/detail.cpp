// SPDX-License-Identifier: MIT
#include "e2lf/depth/detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf::depth {
namespace {

constexpr ptrdiff_t kRadius = 4;
constexpr size_t kTaps = 2 * kRadius + 1;
constexpr float kSigmaPx = 2.0F;
/// The difference in brightness that reduces the weight of a neighbour to a quarter.
constexpr float kUnlike = 0.04F;
/// What remains of the mean keeps the strong edges of untextured objects.
constexpr float kShare = 0.7F;

using Lines = std::array<const float*, kTaps>;

std::array<float, kTaps> gaussian() {
  std::array<float, kTaps> taps{};
  for (size_t k = 0; k < kTaps; ++k) {
    const auto offset = static_cast<float>(static_cast<ptrdiff_t>(k) - kRadius) / kSigmaPx;
    taps[k] = std::exp(-0.5F * offset * offset);
  }
  return taps;
}

/// Computes the weighted mean of each pixel of the middle line and of those beside it in the other lines.
void mean_of_similar(const Lines& lines, size_t count, float* mean) {
  static const std::array<float, kTaps> taps = gaussian();
  const float* const middle = lines[kRadius];
  for (size_t x = 0; x < count; ++x) {
    float sum = 0, total = 0;
    for (size_t k = 0; k < kTaps; ++k) {
      const float ratio = (lines[k][x] - middle[x]) * (1 / kUnlike);
      const float unlike = 1 + ratio * ratio;
      const float weight = taps[k] / (unlike * unlike);
      sum += weight * lines[k][x];
      total += weight;
    }
    mean[x] = sum / total;
  }
}

/// Computes the means along rows.
void mean_along_rows(const float* view, size_t height, size_t width, float* mean) {
  std::vector<float> padded(width + 2 * kRadius);
  Lines lines;
  for (size_t k = 0; k < kTaps; ++k) lines[k] = padded.data() + k;
  for (size_t y = 0; y < height; ++y) {
    const float* const row = view + y * width;
    std::fill_n(padded.begin(), kRadius, row[0]);
    std::copy_n(row, width, padded.begin() + kRadius);
    std::fill_n(padded.end() - kRadius, kRadius, row[width - 1]);
    mean_of_similar(lines, width, mean + y * width);
  }
}

/// Subtracts from a view the means of its rows, averaged along columns.
void subtract_mean(const std::vector<float>& row_means, size_t height, size_t width, float* view) {
  std::vector<float> mean(width);
  Lines lines;
  for (size_t y = 0; y < height; ++y) {
    for (size_t k = 0; k < kTaps; ++k) {
      const ptrdiff_t row = static_cast<ptrdiff_t>(y + k) - kRadius;
      lines[k] = row_means.data() +
                 std::clamp<ptrdiff_t>(row, 0, static_cast<ptrdiff_t>(height) - 1) * static_cast<ptrdiff_t>(width);
    }
    mean_of_similar(lines, width, mean.data());
    for (size_t x = 0; x < width; ++x) view[y * width + x] -= kShare * mean[x];
  }
}

}  // namespace

lightfield::LightField detail_of(const lightfield::LightField& light_field) {
  const lightfield::Shape& shape = light_field.shape();
  E2LF_REQUIRE(shape.channels == 1, "a grey light field");
  lightfield::LightField detail = light_field;
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    std::vector<float> row_means(shape.height * shape.width);
    for (size_t view = begin; view < end && !stop_requested(); ++view) {
      const auto values = detail.view(view / shape.views_x, view % shape.views_x);
      mean_along_rows(values.data(), shape.height, shape.width, row_means.data());
      subtract_mean(row_means, shape.height, shape.width, values.data());
    }
  });
  return detail;
}

}  // namespace e2lf::depth
