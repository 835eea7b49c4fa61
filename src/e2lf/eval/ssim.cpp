// SPDX-License-Identifier: MIT
#include "e2lf/eval/ssim.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "e2lf/base/contract.h"

namespace e2lf::eval {
namespace {

constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

/// Returns the one-dimensional weights of a window, with sum 1. Both windows are separable.
std::vector<double> window_weights(SsimWindow window) {
  const size_t size = ssim_window_size(window);
  std::vector<double> weights(size, 1.0);
  if (window == SsimWindow::kGaussian11) {
    constexpr double kSigma = 1.5;
    const double centre = static_cast<double>(size - 1) / 2;
    for (size_t i = 0; i < size; ++i) {
      const double offset = (static_cast<double>(i) - centre) / kSigma;
      weights[i] = std::exp(-0.5 * offset * offset);
    }
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Windowed means of one row of windows: a, b, a^2 + b^2 (SSIM needs only the sum of the variances) and a * b.
struct MomentRows {
  explicit MomentRows(size_t width) : a(width), b(width), squares(width), product(width) {}
  std::vector<double> a, b, squares, product;
};

/// Filters vertically: computes the moments of each column over the rows of the window that starts at `image_*`.
void filter_columns(const float* image_a, const float* image_b, size_t width, const std::vector<double>& weights,
                    MomentRows& columns) {
  columns = MomentRows(width);
  for (size_t i = 0; i < weights.size(); ++i) {
    const float* row_a = image_a + i * width;
    const float* row_b = image_b + i * width;
    const double weight = weights[i];
    for (size_t x = 0; x < width; ++x) {
      const double a = row_a[x], b = row_b[x];
      columns.a[x] += weight * a;
      columns.b[x] += weight * b;
      columns.squares[x] += weight * (a * a + b * b);
      columns.product[x] += weight * (a * b);
    }
  }
}

/// Filters horizontally, for the windows that lie inside the row.
void filter_row(const std::vector<double>& columns, const std::vector<double>& weights, std::vector<double>& row) {
  std::fill(row.begin(), row.end(), 0.0);
  for (size_t i = 0; i < weights.size(); ++i) {
    const double* shifted = columns.data() + i;
    for (size_t x = 0; x < row.size(); ++x) row[x] += weights[i] * shifted[x];
  }
}

double sum_of_ssim(const MomentRows& moments, double covariance_scale) {
  double sum = 0;
  for (size_t x = 0; x < moments.a.size(); ++x) {
    const double means = moments.a[x] * moments.b[x];
    const double mean_squares = moments.a[x] * moments.a[x] + moments.b[x] * moments.b[x];
    const double variances = covariance_scale * (moments.squares[x] - mean_squares);
    const double covariance = covariance_scale * (moments.product[x] - means);
    sum += (2 * means + kC1) * (2 * covariance + kC2) / ((mean_squares + kC1) * (variances + kC2));
  }
  return sum;
}

}  // namespace

size_t ssim_window_size(SsimWindow window) {
  return window == SsimWindow::kUniform7 ? 7 : 11;
}

double ssim(std::span<const float> image_a, std::span<const float> image_b, size_t height, size_t width,
            SsimWindow window) {
  const size_t size = ssim_window_size(window);
  E2LF_REQUIRE(image_a.size() == height * width && image_b.size() == height * width, "images must be height * width");
  E2LF_REQUIRE(height >= size && width >= size, "an image must be as large as the SSIM window");
  const std::vector<double> weights = window_weights(window);
  const auto window_pixels = static_cast<double>(size * size);
  const double covariance_scale = window_pixels / (window_pixels - 1);
  const size_t rows = height - size + 1, columns_out = width - size + 1;

  MomentRows columns(width), moments(columns_out);
  double sum = 0;
  for (size_t y = 0; y < rows; ++y) {
    filter_columns(image_a.data() + y * width, image_b.data() + y * width, width, weights, columns);
    filter_row(columns.a, weights, moments.a);
    filter_row(columns.b, weights, moments.b);
    filter_row(columns.squares, weights, moments.squares);
    filter_row(columns.product, weights, moments.product);
    sum += sum_of_ssim(moments, covariance_scale);
  }
  return sum / static_cast<double>(rows * columns_out);
}

}  // namespace e2lf::eval
