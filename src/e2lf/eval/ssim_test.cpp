// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/rng.h"
#include "e2lf/eval/metrics.h"

namespace e2lf::eval {
namespace {

std::vector<float> noise(size_t count, uint64_t seed) {
  const CounterRng rng(seed, 0);
  std::vector<float> values(count);
  for (size_t i = 0; i < count; ++i) values[i] = rng.uniform(i);
  return values;
}

/// Weight of the window's pixel (dy, dx), not normalised.
double weight(SsimWindow window, double dy, double dx) {
  return window == SsimWindow::kUniform7 ? 1.0 : std::exp(-(dy * dy + dx * dx) / (2 * 1.5 * 1.5));
}

/// SSIM of one window straight from its definition: weighted means, centred second moments.
double direct_ssim_at(const std::vector<float>& a, const std::vector<float>& b, size_t width, size_t y, size_t x,
                      SsimWindow window) {
  const int radius = window == SsimWindow::kUniform7 ? 3 : 5;
  auto average = [&](auto&& value) {
    double sum = 0, weights = 0;
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -radius; dx <= radius; ++dx) {
        const size_t i = (y + dy) * width + x + dx;
        sum += weight(window, dy, dx) * value(i);
        weights += weight(window, dy, dx);
      }
    }
    return sum / weights;
  };
  const double mean_a = average([&](size_t i) { return a[i]; }), mean_b = average([&](size_t i) { return b[i]; });
  const double pixels = (2.0 * radius + 1) * (2.0 * radius + 1), scale = pixels / (pixels - 1);
  const double variance_a = scale * average([&](size_t i) { return (a[i] - mean_a) * (a[i] - mean_a); });
  const double variance_b = scale * average([&](size_t i) { return (b[i] - mean_b) * (b[i] - mean_b); });
  const double covariance = scale * average([&](size_t i) { return (a[i] - mean_a) * (b[i] - mean_b); });
  const double c1 = 1e-4, c2 = 9e-4;
  return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
         ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
}

double direct_ssim(const std::vector<float>& a, const std::vector<float>& b, size_t height, size_t width,
                   SsimWindow window) {
  const size_t radius = window == SsimWindow::kUniform7 ? 3 : 5;
  double sum = 0;
  for (size_t y = radius; y + radius < height; ++y) {
    for (size_t x = radius; x + radius < width; ++x) sum += direct_ssim_at(a, b, width, y, x, window);
  }
  return sum / static_cast<double>((height - 2 * radius) * (width - 2 * radius));
}

class Ssim : public testing::TestWithParam<SsimWindow> {};
INSTANTIATE_TEST_SUITE_P(Windows, Ssim, testing::Values(SsimWindow::kUniform7, SsimWindow::kGaussian11),
                         [](const auto& test) {
                           return test.param == SsimWindow::kUniform7 ? std::string("Uniform7") : "Gaussian11";
                         });

TEST_P(Ssim, MatchesItsDefinition) {
  for (const auto& [height, width] : {std::pair<size_t, size_t>{23, 37}, {11, 11}, {12, 19}}) {
    const auto a = noise(height * width, 1);
    auto b = noise(height * width, 2);
    for (size_t i = 0; i < b.size(); ++i) b[i] = 0.7F * a[i] + 0.3F * b[i];
    EXPECT_NEAR(ssim(a, b, height, width, GetParam()), direct_ssim(a, b, height, width, GetParam()), 1e-9);
  }
}

TEST_P(Ssim, OfEqualImagesIsOne) {
  const auto image = noise(20 * 30, 3);
  EXPECT_NEAR(ssim(image, image, 20, 30, GetParam()), 1.0, 1e-12);
}

TEST_P(Ssim, OfConstantImagesComparesTheirMeans) {
  const std::vector<float> a(15 * 15, 0.25F), b(15 * 15, 0.75F);
  const double expected = (2 * 0.25 * 0.75 + 1e-4) / (0.25 * 0.25 + 0.75 * 0.75 + 1e-4);
  EXPECT_NEAR(ssim(a, b, 15, 15, GetParam()), expected, 1e-9);
}

TEST_P(Ssim, RefusesAnImageSmallerThanItsWindow) {
  const size_t size = ssim_window_size(GetParam());
  const std::vector<float> image(size * (size - 1));
  EXPECT_THROW((void)ssim(image, image, size, size - 1, GetParam()), ContractError);
}

/// Figures of scikit-image 0.19.3: structural_similarity(a, b, data_range=1), and with gaussian_weights=True.
TEST(SsimScikitImage, GivesTheSameFigures) {
  struct Golden {
    size_t height, width;
    double uniform7, gaussian11;
  };
  for (const Golden& golden :
       {Golden{20, 31, 0.925855980856, 0.928821932656}, Golden{11, 11, 0.935306753232, 0.941056944839}}) {
    std::vector<float> a, b;
    for (size_t y = 0; y < golden.height; ++y) {
      for (size_t x = 0; x < golden.width; ++x) {
        a.push_back(static_cast<float>((7 * x + 13 * y + x * y) % 32) / 32);
        b.push_back((3 * a.back() + static_cast<float>((5 * x + 3 * y * y) % 64) / 64) / 4);
      }
    }
    EXPECT_NEAR(ssim(a, b, golden.height, golden.width, SsimWindow::kUniform7), golden.uniform7, 1e-9);
    EXPECT_NEAR(ssim(a, b, golden.height, golden.width, SsimWindow::kGaussian11), golden.gaussian11, 1e-9);
  }
}

TEST(SsimUniform7, UsesTheSampleCovarianceOfOneWindow) {
  // One 7x7 window, b = 0 except for one pixel of value 1: mean 1/49, sample variance (1 - 1/49) / 48 = 1/49.
  const std::vector<float> a(49, 0.0F);
  auto b = a;
  b[24] = 1.0F;
  const double mean = 1.0 / 49;
  EXPECT_NEAR(ssim(a, b, 7, 7, SsimWindow::kUniform7), 1e-4 * 9e-4 / ((mean * mean + 1e-4) * (mean + 9e-4)), 1e-12);
}

}  // namespace
}  // namespace e2lf::eval
