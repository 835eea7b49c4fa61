// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// PFM as HCI's benchmark and Middlebury use it: "Pf", grey float32, little-endian, rows bottom to top.
[[nodiscard]] std::vector<uint8_t> encode_pfm(const lightfield::Image& grey);

/// The inverse; either byte order. Fails with kFormat, kTruncated and kUnsupported (colour).
[[nodiscard]] Result<lightfield::Image> decode_pfm(std::span<const uint8_t> bytes, const std::string& name);

/// What a 16-bit PNG of disparities stores: sample = 32768 + 4096 d, clamped, so d reaches from -8 to 8 px.
inline constexpr float kPngZero = 32768.0F, kPngScale = 4096.0F;

/// The image whose 16-bit PNG has these samples.
[[nodiscard]] lightfield::Image png_samples(const lightfield::Image& disparity);

/// A picture to look at: dark blue is far (range.most), then cyan, green and yellow, red is near (range.least); the
/// darker, the less confidence.
[[nodiscard]] lightfield::Image colour_picture(const DisparityMap& map, const DisparityRange& range);

/// The smallest and largest disparity of the pixels with a confidence above 0.3 (of all where these are few), but for a
/// hundredth at either end.
[[nodiscard]] DisparityRange shown_range(const DisparityMap& map);

/// How disparities become places: an array of pinholes, one view step apart, whose pictures show the same rectangle at
/// the focus distance, which is 1. Depth z = 1 / (1 - d / infinity_px): 1 where d is 0.
struct PointGeometry {
  float infinity_px = 4;     ///< the disparity of what is infinitely far: positive, more than any there is
  float field_width = 0.8F;  ///< of what a view shows at the focus distance
};

/// An infinity for light fields of unknown cameras: as far beyond the largest disparity as that is from the smallest,
/// at least 1 px beyond it, and at least 1 px.
[[nodiscard]] float assumed_infinity(const DisparityRange& range);

/// A binary PLY file of points: float x (right), y (down), z (away), uchar grey or red, green, blue as `picture` has
/// them, float confidence. Pixels with less confidence than `least_confidence` are left out. Fails with kInvalidValue
/// where a disparity reaches infinity_px.
[[nodiscard]] Result<std::vector<uint8_t>> encode_point_cloud(const DisparityMap& map, const lightfield::Image& picture,
                                                              const lightfield::Shape& views,
                                                              const PointGeometry& geometry, float least_confidence);

}  // namespace e2lf::depth
