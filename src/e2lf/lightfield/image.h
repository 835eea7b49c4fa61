// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::lightfield {

/// An image: pixels [y, x, channel], row-major; `channels` is 1 (grey) or 3 (red, green, blue).
template <typename T>
struct BasicImage {
  size_t width = 0, height = 0, channels = 1;
  std::vector<T> pixels;

  BasicImage() = default;
  BasicImage(size_t width_, size_t height_, size_t channels_)
      : width(width_), height(height_), channels(channels_), pixels(width_ * height_ * channels_) {}
  bool operator==(const BasicImage&) const = default;
};

using Image = BasicImage<float>;        ///< in [0, 1]
using ByteImage = BasicImage<uint8_t>;  ///< for pictures that are only displayed

enum class PngDepth { k8, k16 };

/// Returns the full-range luma of a colour (ITU-R BT.601): 0.299 red + 0.587 green + 0.114 blue. A grey colour keeps
/// its exact value.
[[nodiscard]] inline float grey_of(float red, float green, float blue) {
  return green + 0.299F * (red - green) + 0.114F * (blue - green);
}

/// Converts a colour image to grey. A grey image is returned unchanged.
[[nodiscard]] Image to_grey(Image image);

/// Converts an image to 8 bits as round(255 * clamp(value)); NaN becomes 0.
[[nodiscard]] ByteImage to_bytes(const Image& image);

/// Decodes a PNG (any depth, grey, colour or palette; alpha is dropped, and no gamma is applied) or a JPEG (grey or
/// colour) in memory. The samples are divided by the largest value of their depth. `name` is the location in errors.
/// Fails with kFormat (neither format, or damaged), kTruncated and kUnsupported (a CMYK JPEG). An image that claims
/// more pixels than its bytes can hold is rejected before memory is allocated for it.
[[nodiscard]] Result<Image> decode_image(std::span<const uint8_t> bytes, const std::string& name);

/// Reads an image file and decodes it as decode_image does. The format is detected from its bytes, not from its name.
/// Also fails with kNotFound and kIo.
[[nodiscard]] Result<Image> read_image(const std::filesystem::path& path);

/// Encodes a PNG with little compression, for speed. 16-bit samples are round(65535 * clamp(value)). Fails
/// with kInternal if libpng fails.
[[nodiscard]] Result<std::vector<uint8_t>> encode_png(const Image& image, PngDepth depth);
[[nodiscard]] Result<std::vector<uint8_t>> encode_png(const ByteImage& image);

/// Encodes a PNG into a file that appears either whole or not at all. Fails as encode_png does, and with kIo.
[[nodiscard]] Result<void> write_png(const std::filesystem::path& path, const Image& image,
                                     PngDepth depth = PngDepth::k8);
[[nodiscard]] Result<void> write_png(const std::filesystem::path& path, const ByteImage& image);

/// Encodes a grey picture as PNG with 1 bit per pixel, white from 128 on. Fails with kInternal if libpng fails. A
/// colour picture breaks the contract.
[[nodiscard]] Result<std::vector<uint8_t>> encode_bilevel_png(const ByteImage& image);

}  // namespace e2lf::lightfield
