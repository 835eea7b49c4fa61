// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity_files.h"

#include <cstring>
#include <gtest/gtest.h>

namespace e2lf::depth {
namespace {

using lightfield::Image;

DisparityMap small_map() {
  DisparityMap map{Image(3, 2, 1), Image(3, 2, 1), {4, 4}, {-1, 1}, 0};
  map.disparity.pixels = {-1, 0, 1, 0.25F, 0.5F, 0.75F};
  map.confidence.pixels = {1, 1, 1, 0.1F, 1, 1};
  return map;
}

TEST(Pfm, HasTheRowsAndTheSignOfTheBenchmark) {
  const Image image = small_map().disparity;
  const std::vector<uint8_t> bytes = encode_pfm(image);
  const std::string header = "Pf\n3 2\n-1.0\n";
  ASSERT_EQ(bytes.size(), header.size() + 24);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(header.size())), header);
  float first = 0;
  std::memcpy(&first, bytes.data() + header.size(), 4);
  EXPECT_EQ(first, -0.25F);
  EXPECT_EQ(decode_pfm(bytes, "a.pfm").value(), image);
}

TEST(Pfm, ReadsEitherByteOrderAndRefusesDamage) {
  const std::string big = std::string("Pf 1 1 1.0\n") + std::string("\x3F\x80\x00\x00", 4);
  const auto span = [](const std::string& text) {
    return std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size());
  };
  EXPECT_EQ(decode_pfm(span(big), "a").value().pixels[0], -1.0F);
  const std::string windows = "Pf\r\n1 1\r\n1.0\r\n" + big.substr(big.find('\n') + 1);
  EXPECT_EQ(decode_pfm(span(windows), "a").value().pixels[0], -1.0F);
  EXPECT_EQ(decode_pfm(span(big + "more"), "a").error().code, ErrorCode::kFormat);
  EXPECT_EQ(decode_pfm(span(big.substr(0, 13)), "a").error().code, ErrorCode::kTruncated);
  EXPECT_EQ(decode_pfm(span("Pf 99999999999 99999999999 1.0\n"), "a").error().code, ErrorCode::kTruncated);
  EXPECT_EQ(decode_pfm(span("PF 1 1 1.0\n"), "a").error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(decode_pfm(span("P5 1 1 255\n"), "a").error().code, ErrorCode::kFormat);
  EXPECT_EQ(decode_pfm(span("Pf -1 nan"), "a").ok(), false);
  EXPECT_EQ(decode_pfm(span(""), "a").error().code, ErrorCode::kFormat);
}

TEST(PngSamples, SayTheDisparity) {
  const auto png = lightfield::encode_png(png_samples(small_map().disparity), lightfield::PngDepth::k16).value();
  const Image back = lightfield::decode_image(png, "a.png").value();
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR((65535 * back.pixels[i] - kPngZero) / kPngScale, small_map().disparity.pixels[i], 0.5 / kPngScale);
  }
}

TEST(PointCloud, LeavesOutUncertainPointsBesideJumps) {
  DisparityMap map{Image(4, 1, 1), Image(4, 1, 1), {}, {0, 1}, 0};
  map.disparity.pixels = {0, 0, 1, 1};
  map.confidence.pixels = {0.5F, 0.5F, 0.9F, 0.5F};
  const auto bytes = encode_point_cloud(map, Image(4, 1, 1), {1, 2, 1, 4, 1}, {}, 0);
  const std::string text(bytes->begin(), bytes->end());
  EXPECT_NE(text.find("element vertex 3\n"), std::string::npos);
}

TEST(PointCloud, PutsPointsWhereTheyAre) {
  const auto bytes =
      encode_point_cloud(small_map(), Image(3, 2, 1), {9, 9, 2, 3, 1}, {.infinity_px = 2, .field_width = 3}, 0.5F);
  ASSERT_TRUE(bytes.ok());
  const std::string text(bytes->begin(), bytes->end());
  EXPECT_NE(text.find("element vertex 5\n"), std::string::npos);  // one has too little confidence
  const size_t data = text.find("end_header\n") + 11;
  constexpr size_t kPointBytes = 17;
  ASSERT_EQ(text.size(), data + 5 * kPointBytes);
  float point[3];
  std::memcpy(point, text.data() + data, sizeof(point));
  // d = -1 of 2: z = 1 / 1.5; the pixel's middle is one pixel left of and half a pixel above the axis.
  EXPECT_NEAR(point[2], 1 / 1.5, 1e-6);
  EXPECT_NEAR(point[0], -1 / 1.5, 1e-6);
  EXPECT_NEAR(point[1], -0.5 / 1.5, 1e-6);
  EXPECT_EQ(encode_point_cloud(small_map(), Image(3, 2, 1), {9, 9, 2, 3, 1}, {.infinity_px = 1, .field_width = 3}, 0)
                .error()
                .code,
            ErrorCode::kInvalidValue);
}

TEST(PointCloud, HasTheColoursOfThePicture) {
  Image picture(3, 2, 3);
  picture.pixels[0] = 1;
  picture.pixels[1] = 0.2F;
  const auto bytes = encode_point_cloud(small_map(), picture, {9, 9, 2, 3, 1}, {.infinity_px = 2, .field_width = 3}, 0);
  ASSERT_TRUE(bytes.ok());
  const std::string text(bytes->begin(), bytes->end());
  EXPECT_NE(text.find("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float confidence\n"),
            std::string::npos);
  const size_t data = text.find("end_header\n") + 11;
  constexpr size_t kPointBytes = 19;
  ASSERT_EQ(text.size(), data + 5 * kPointBytes);  // one is uncertain beside a jump
  EXPECT_EQ(bytes->at(data + 12), 255);
  EXPECT_EQ(bytes->at(data + 13), 51);
  EXPECT_EQ(bytes->at(data + 14), 0);
}

TEST(AssumedInfinity, LiesBeyondAllDisparities) {
  EXPECT_EQ(assumed_infinity({-2, 1}), 4);
  EXPECT_EQ(assumed_infinity({0.5F, 0.5F}), 1.5F);
  EXPECT_EQ(assumed_infinity({-3, -2.5F}), 1);
}

/// Returns the first points of a PLY file with one channel.
std::vector<std::array<float, 3>> points_of(const std::vector<uint8_t>& bytes, size_t count) {
  const std::string text(bytes.begin(), bytes.end());
  const size_t begin = text.find("end_header\n") + 11, size = 3 * sizeof(float) + 1 + sizeof(float);
  std::vector<std::array<float, 3>> points(count);
  for (size_t i = 0; i < count; ++i) std::memcpy(points[i].data(), bytes.data() + begin + i * size, sizeof points[i]);
  return points;
}

TEST(PointCloud, IsInMetresWithACalibratedLens) {
  // Points of a plane z = 0.5 + 0.2 x in metres, seen by the view right of the calibrated one and above it.
  Lens lens{.width = 40,
            .height = 30,
            .focal_px = {50, 52},
            .centre_px = {19, 15.5},
            .distortion = {-0.2, 0.05, 0.001, -0.002, 0.01},
            .baseline_m = 0.003,
            .focus_m = 0.6};
  DisparityMap map;
  map.view = {3, 5};
  map.disparity = map.confidence = Image(40, 30, 1);
  const double pinhole_x = 0.003, pinhole_y = -0.003;
  for (size_t i = 0; i < 1200; ++i) {
    const auto [ray_x, ray_y] = lens.ray(static_cast<double>(i % 40), static_cast<double>(i / 40));
    // The ray from the pinhole through the point at the focus distance meets the plane at z.
    const double slope_x = ray_x - pinhole_x / lens.focus_m;
    const double z = (0.5 + 0.2 * pinhole_x) / (1 - 0.2 * slope_x);
    map.disparity.pixels[i] = static_cast<float>(lens.infinity_px() * (1 - lens.focus_m / z));
    map.confidence.pixels[i] = 1;
  }
  const auto bytes = encode_point_cloud(map, Image(40, 30, 1), {8, 8, 30, 40, 1}, {.lens = lens}, 0);
  ASSERT_TRUE(bytes) << bytes.error().message;
  for (const auto& [x, y, z] : points_of(*bytes, 1200)) {
    ASSERT_NEAR(z, 0.5 + 0.2 * static_cast<double>(x), 1e-5);
    ASSERT_LT(std::abs(static_cast<double>(y) - pinhole_y), 0.3);
  }
  EXPECT_NEAR(static_cast<double>(depth_image(map.disparity, lens).pixels[0]),
              static_cast<double>(points_of(*bytes, 1)[0][2]), 1e-5);
  lens.width = 41;
  EXPECT_EQ(encode_point_cloud(map, Image(40, 30, 1), {8, 8, 30, 40, 1}, {.lens = lens}, 0).error().code,
            ErrorCode::kShape);
}

TEST(Lens, InvertsTheDistortion) {
  const Lens lens{.width = 40,
                  .height = 30,
                  .focal_px = {50, 52},
                  .centre_px = {19, 15.5},
                  .distortion = {-0.2, 0.05, 0.001, -0.002, 0.01},
                  .baseline_m = 0.003,
                  .focus_m = 0.6};
  const double x = 0.3, y = -0.25, r2 = x * x + y * y, radial = 1 + r2 * (-0.2 + r2 * (0.05 + r2 * 0.01));
  const double seen_x = x * radial + 2 * 0.001 * x * y - 0.002 * (r2 + 2 * x * x);
  const double seen_y = y * radial + 0.001 * (r2 + 2 * y * y) - 2 * 0.002 * x * y;
  const auto [ray_x, ray_y] = lens.ray(50 * seen_x + 19, 52 * seen_y + 15.5);
  EXPECT_NEAR(ray_x, x, 1e-6);
  EXPECT_NEAR(ray_y, y, 1e-6);
  EXPECT_NEAR(lens.depth_m(0), 0.6, 1e-12);
}

}  // namespace
}  // namespace e2lf::depth
