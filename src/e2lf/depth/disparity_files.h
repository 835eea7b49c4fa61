// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// Encodes a disparity map as a PFM file of the HCI 4D Light Field Benchmark: "Pf", float32, little-endian, rows from
/// bottom to top, with the sign of the benchmark, whose disparities are larger for nearer points: each is -d.
[[nodiscard]] std::vector<uint8_t> encode_pfm(const lightfield::Image& disparity);

/// Decodes such a disparity map, of either byte order, and returns d. Fails with kFormat, kTruncated and kUnsupported
/// (colour).
[[nodiscard]] Result<lightfield::Image> decode_pfm(std::span<const uint8_t> bytes, const std::string& name);

/// The encoding of disparities in a 16-bit PNG: sample = 32768 + 4096 d, clamped, so that d ranges from -8 to 8 px.
inline constexpr float kPngZero = 32768.0F, kPngScale = 4096.0F;

/// Returns the image whose 16-bit PNG has these samples.
[[nodiscard]] lightfield::Image png_samples(const lightfield::Image& disparity);

/// A calibrated lens with a coded aperture. The middle view is a pinhole camera with the constants of OpenCV's
/// calibrateCamera(); the others are displaced by the baseline and show the same rectangle at the focus distance.
struct Lens {
  size_t width = 0, height = 0;           ///< size of the calibrated views, px
  std::array<double, 2> focal_px = {};    ///< focal lengths along x and y
  std::array<double, 2> centre_px = {};   ///< principal point (x, y); the middle of the first pixel is (0, 0)
  std::array<double, 5> distortion = {};  ///< k1, k2, p1, p2, k3
  double baseline_m = 0;                  ///< distance of neighbouring views
  double focus_m = 0;                     ///< distance at which the disparity is 0

  /// Returns the disparity at infinite distance, px per view step: focal_px[0] * baseline_m / focus_m.
  [[nodiscard]] double infinity_px() const { return focal_px[0] * baseline_m / focus_m; }

  /// Returns the depth of a disparity, in metres; infinite or negative for disparities of at least infinity_px().
  [[nodiscard]] double depth_m(double disparity_px) const { return focus_m / (1 - disparity_px / infinity_px()); }

  /// Returns (x, y) at depth 1 of the ray through a pixel of the middle view, without the distortion.
  [[nodiscard]] std::array<double, 2> ray(double x_px, double y_px) const;
};

/// Reads {"width", "height", "focal_px": [x, y], "centre_px": [x, y], "distortion": [k1, k2, p1, p2, k3], "baseline_m",
/// "focus_m"}, as examples/lens/calibrate_lens.py writes it. Fails with kInvalidValue if a length is not positive.
[[nodiscard]] Result<Lens> read_lens(const std::filesystem::path& path);

/// The geometry that relates disparities to positions: an array of pinholes, one view step apart, whose pictures show
/// the same rectangle at the focus distance, which is 1. The depth is z = 1 / (1 - d / infinity_px), which is 1 for d =
/// 0.
struct PointGeometry {
  float infinity_px = 4;          ///< the disparity at infinity, positive and larger than any other
  float field_width = 0.8F;       ///< width of the visible rectangle at the focus distance
  std::optional<Lens> lens = {};  ///< replaces all of them; positions are in metres from the middle view
};

/// Returns a disparity at infinity for light fields of unknown cameras. It exceeds the largest disparity by the width
/// of the range, but at least by 1 px, and is at least 1 px.
[[nodiscard]] float assumed_infinity(const DisparityRange& range);

/// Returns the depth [y, x] in metres, NaN where the disparity is at least that of infinity.
[[nodiscard]] lightfield::Image depth_image(const lightfield::Image& disparity, const Lens& lens);

/// Encodes a binary PLY file of points: float x (right), y (down), z (away), uchar grey or red, green, blue depending
/// on `picture`, and float confidence. Pixels with a confidence below `least_confidence` are omitted, as are those
/// below 0.6 beside a jump of the disparity, which would hang between two surfaces. Fails with kInvalidValue if a
/// disparity reaches infinity_px, and with kShape if the lens was calibrated at another size.
[[nodiscard]] Result<std::vector<uint8_t>> encode_point_cloud(const DisparityMap& map, const lightfield::Image& picture,
                                                              const lightfield::Shape& views,
                                                              const PointGeometry& geometry, float least_confidence);

}  // namespace e2lf::depth
