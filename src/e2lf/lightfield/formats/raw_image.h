// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::lightfield {

/// An image as a file stores it: rows of samples [y, x, channel] of 8 bits, or 16 bits in this machine's byte order.
struct RawImage {
  size_t width = 0, height = 0;
  size_t channels = 1;      ///< 1 or 3
  size_t sample_bytes = 1;  ///< 1 or 2
  bool is_bilevel = false;  ///< written only: grey with one bit per pixel, eight to a byte, the first in the high bit
  std::string view_grid;    ///< of a lenslet mosaic, "8x8": rows x columns of views, as text in a PNG; empty = unsaid
  std::vector<uint8_t> samples;

  [[nodiscard]] size_t row_bytes() const { return is_bilevel ? (width + 7) / 8 : width * channels * sample_bytes; }
};

[[nodiscard]] bool is_png(std::span<const uint8_t> bytes);
[[nodiscard]] bool is_jpeg(std::span<const uint8_t> bytes);

/// Refuses a size that an image file claims but cannot hold (`least_bytes`: the fewest it would take), or that is
/// beyond 2^28 pixels. Called before anything is allocated for the pixels.
[[nodiscard]] Result<void> check_image_size(const RawImage& image, double least_bytes, size_t file_bytes,
                                            const std::string& name);

/// What decode_image does for one kind, without the conversion to float.
[[nodiscard]] Result<RawImage> decode_png(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] Result<RawImage> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name);

/// Either of them, by the first bytes. Fails with kFormat where it is neither.
[[nodiscard]] Result<RawImage> decode_raw_image(std::span<const uint8_t> bytes, const std::string& name);

/// The largest sample: 255 or 65535.
[[nodiscard]] float largest_sample(const RawImage& image);

/// The samples divided by `white`.
[[nodiscard]] Image to_float(const RawImage& image, float white);

/// Compresses the rows of `image`, which are in PNG's byte order (16 bits: high byte first).
[[nodiscard]] Result<std::vector<uint8_t>> encode_png_rows(const RawImage& image);

}  // namespace e2lf::lightfield
