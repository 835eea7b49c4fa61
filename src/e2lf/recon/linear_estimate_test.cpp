// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/recon/inversion.h"

namespace e2lf::recon {
namespace {

/// A smooth texture with detail of a few pixels.
float texture(double y, double x) {
  return static_cast<float>(0.5 + 0.2 * std::sin(0.7 * x + 0.3 * y) + 0.2 * std::sin(0.5 * y - 0.4 * x) +
                            0.1 * std::sin(0.23 * x * std::cos(0.02 * y)));
}

/// One plane at `disparity`; a point at x in the centre is at x + d * (view - 3.5).
lightfield::LightField plane(double disparity, size_t height = 48, size_t width = 56) {
  lightfield::LightField light_field({8, 8, height, width});
  for (size_t v = 0; v < 64; ++v) {
    const double dy = disparity * (static_cast<double>(v / 8) - 3.5),
                 dx = disparity * (static_cast<double>(v % 8) - 3.5);
    for (size_t i = 0; i < height * width; ++i) {
      light_field.view(v / 8, v % 8)[i] =
          texture(static_cast<double>(i / width) - dy, static_cast<double>(i % width) - dx);
    }
  }
  return light_field;
}

/// Black, then one open cell each at three corners.
capture::Codes corner_codes() {
  capture::Codes codes(4, 8, 8);
  codes.pattern(1)[1 * 8 + 1] = codes.pattern(2)[6 * 8 + 3] = codes.pattern(3)[2 * 8 + 6] = 1;
  return codes;
}

capture::CodedIntensities code(const capture::Codes& codes, const lightfield::LightField& light_field) {
  const auto& shape = light_field.shape();
  capture::CodedIntensities intensities(codes.num_patterns, shape.height, shape.width);
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    for (size_t v = 0; v < shape.num_views(); ++v) {
      for (size_t i = 0; i < shape.view_size(); ++i) {
        intensities.image(n)[i] += codes.pattern(n)[v] * light_field.data()[v * shape.view_size() + i] / 64;
      }
    }
  }
  return intensities;
}

/// Root mean square error away from the borders, where the scene goes on.
double interior_error(const lightfield::LightField& a, const lightfield::LightField& b) {
  const auto& shape = a.shape();
  const size_t margin = 12;
  double sum = 0;
  size_t count = 0;
  for (size_t v = 0; v < 64; ++v) {
    for (size_t y = margin; y < shape.height - margin; ++y) {
      for (size_t x = margin; x < shape.width - margin; ++x, ++count) {
        const double error = double{a.at(v / 8, v % 8, y, x)} - double{b.at(v / 8, v % 8, y, x)};
        sum += error * error;
      }
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

TEST(ViewWeights, SumToOneAndIgnoreBlackPatterns) {
  for (const auto& weights : view_weights(corner_codes(), {})) {
    EXPECT_NEAR(weights[0] + weights[1] + weights[2] + weights[3], 1, 1e-12);
    EXPECT_EQ(weights[0], 0);
  }
}

TEST(ViewWeights, WithoutNoiseAnOpenCellIsItsOwnView) {
  const auto weights = view_weights(corner_codes(), {.correlation_length = 4, .noise = 0});
  EXPECT_NEAR(weights[1 * 8 + 1][1], 1, 1e-9);
  EXPECT_NEAR(weights[6 * 8 + 3][2], 1, 1e-9);
  EXPECT_NEAR(weights[2 * 8 + 6][3], 1, 1e-9);
}

TEST(CodedDisparity, FindsThePlane) {
  const capture::Codes codes = corner_codes();
  for (const float disparity : {-1.5F, 0.0F, 0.75F}) {
    const auto light_field = plane(disparity);
    std::vector<PlacedImage> images;
    for (const auto& [y, x] : {std::pair{1, 1}, std::pair{6, 3}, std::pair{2, 6}}) {
      const auto view = light_field.view(static_cast<size_t>(y), static_cast<size_t>(x));
      images.push_back({{view.begin(), view.end()}, y - 3.5, x - 3.5});
    }
    const auto found = coded_disparity(images, 48, 56);
    for (size_t y = 14; y < 34; ++y) {
      for (size_t x = 14; x < 42; ++x) ASSERT_NEAR(found[y * 56 + x], disparity, 0.251) << y << " " << x;
    }
  }
}

TEST(LinearEstimate, RecoversAPlaneFromThreeSingleViews) {
  for (const double disparity : {-1.25, 0.0, 0.5}) {
    const auto truth = plane(disparity);
    const auto estimate = linear_estimate(code(corner_codes(), truth), corner_codes());
    ASSERT_TRUE(estimate);
    ASSERT_EQ(estimate->shape(), truth.shape());
    EXPECT_LT(interior_error(*estimate, truth), 0.015) << disparity;
  }
}

TEST(LinearEstimate, OfOnePatternEveryViewIsItsPicture) {
  capture::Codes codes(2, 8, 8);
  for (float& value : codes.pattern(1)) value = 1;
  const auto intensities = code(codes, plane(0));
  const auto estimate = linear_estimate(intensities, codes);
  ASSERT_TRUE(estimate);
  for (size_t v = 0; v < 64; ++v) {
    for (size_t i = 0; i < intensities.image_size(); ++i) {
      ASSERT_NEAR(estimate->view(v / 8, v % 8)[i], intensities.image(1)[i], 1e-6);
    }
  }
}

TEST(LinearEstimate, WrongInputsAreRefused) {
  const capture::CodedIntensities intensities(3, 4, 4);
  EXPECT_EQ(linear_estimate(intensities, corner_codes()).error().code, ErrorCode::kShape);
  EXPECT_EQ(linear_estimate(intensities, capture::Codes(3, 8, 8)).error().code, ErrorCode::kInvalidValue);
  capture::Codes no_black(3, 8, 8);
  for (float& value : no_black.values) value = 1;
  EXPECT_EQ(reconstruct_by_inversion(capture::EventImages(2, 4, 4), no_black, {}).error().code,
            ErrorCode::kInvalidValue);
  EXPECT_EQ(reconstruct_by_inversion(capture::EventImages(2, 4, 4), corner_codes(), {}).error().code,
            ErrorCode::kShape);
}

TEST(LinearEstimate, EmptyImagesAreRefused) {
  for (const auto& [height, width] : {std::pair<size_t, size_t>{0, 4}, {4, 0}, {0, 0}}) {
    const auto inversion = reconstruct_by_inversion(capture::EventImages(3, height, width), corner_codes(), {});
    EXPECT_EQ(inversion.error().code, ErrorCode::kShape) << height << "x" << width;
    const auto estimate = linear_estimate(capture::CodedIntensities(4, height, width), corner_codes());
    EXPECT_EQ(estimate.error().code, ErrorCode::kShape) << height << "x" << width;
  }
}

TEST(Denoise, AveragesFlatPartsAndKeepsEdges) {
  // A step far above the noise, and a deviating pixel within it.
  capture::EventImages images(1, 20, 20);
  capture::CodedIntensities intensities(2, 20, 20);
  for (size_t i = 0; i < 400; ++i) intensities.image(1)[i] = i % 20 < 10 ? 0.02F : 0.8F;
  intensities.image(1)[10 * 20 + 3] = 0.023F;
  const auto before = intensities;
  denoise_intensities(intensities, images, {}, 2);
  EXPECT_NEAR(intensities.image(1)[10 * 20 + 3], 0.02F, 0.0005F);
  EXPECT_NEAR(intensities.image(1)[10 * 20 + 9], before.image(1)[10 * 20 + 9], 0.003F);
  EXPECT_NEAR(intensities.image(1)[10 * 20 + 10], before.image(1)[10 * 20 + 10], 0.08F);
}

TEST(Inversion, EventsOfAPlaneGiveItsLightFieldWithinQuantisation) {
  const capture::Codes codes = corner_codes();
  const auto truth = plane(0.5);
  auto intensities = code(codes, truth);
  for (float& value : intensities.values) value *= 20;  // single cells are dark: more light, a finer logarithm
  const capture::SensorConstants constants{.eps = 0.01F, .tau = 0.05F, .sigma_w = 0, .sigma_z = 0};
  capture::EventImages images(3, intensities.height, intensities.width);
  for (size_t i = 0; i < images.image_size(); ++i) {
    double reference = std::log(0.01);
    for (size_t k = 0; k < 3; ++k) {
      const double count = std::trunc((std::log(double{intensities.image(k + 1)[i]} + 0.01) - reference) / 0.05);
      images.image(k)[i] = static_cast<int16_t>(count);
      reference += 0.05 * count;
    }
  }
  auto estimate = reconstruct_by_inversion(images, codes, constants);
  ASSERT_TRUE(estimate);
  for (float& value : estimate->data()) value /= 20;
  EXPECT_LT(interior_error(*estimate, truth), 0.025);
}

}  // namespace
}  // namespace e2lf::recon
