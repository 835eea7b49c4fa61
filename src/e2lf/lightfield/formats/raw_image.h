// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::lightfield {

/// An image as a file stores it: rows of samples [y, x, channel] of 8 bits, or of 16 bits in the byte order of this
/// machine.
struct RawImage {
  size_t width = 0, height = 0;
  size_t channels = 1;      ///< 1 or 3
  size_t sample_bytes = 1;  ///< 1 or 2
  bool is_bilevel = false;  ///< used for writing only: one bit per pixel, eight to a byte, the first in the high bit
  std::string view_grid;    ///< grid of a lenslet mosaic, as stored in a PNG: "8x8" (rows x columns); may be empty
  std::vector<uint8_t> samples;

  [[nodiscard]] size_t row_bytes() const { return is_bilevel ? (width + 7) / 8 : width * channels * sample_bytes; }
};

[[nodiscard]] bool is_png(std::span<const uint8_t> bytes);
[[nodiscard]] bool is_jpeg(std::span<const uint8_t> bytes);

/// Rejects an image size that the file cannot hold, where `least_bytes` is the smallest file size that it needs, and
/// sizes beyond 2^28 pixels. It is called before memory is allocated for the pixels.
[[nodiscard]] Result<void> check_image_size(const RawImage& image, double least_bytes, size_t file_bytes,
                                            const std::string& name);

/// Decode one format as decode_image does, but without the conversion to float.
[[nodiscard]] Result<RawImage> decode_png(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] Result<RawImage> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name);

/// Decodes either format, detected from the first bytes. Fails with kFormat if it is neither.
[[nodiscard]] Result<RawImage> decode_raw_image(std::span<const uint8_t> bytes, const std::string& name);

/// Returns the largest value of a sample: 255 or 65535.
[[nodiscard]] float largest_sample(const RawImage& image);

/// Converts the samples to float and divides them by `white`.
[[nodiscard]] Image to_float(const RawImage& image, float white);

/// Compresses the rows of `image`, which must be in PNG's byte order (16 bits: high byte first).
[[nodiscard]] Result<std::vector<uint8_t>> encode_png_rows(const RawImage& image);

}  // namespace e2lf::lightfield
