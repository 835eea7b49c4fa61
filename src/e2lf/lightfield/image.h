// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::lightfield {

/// A picture in float32: pixels [y, x, channel], row-major, in [0, 1]; `channels` is 1 (grey) or 3 (red, green, blue).
struct Image {
  size_t width = 0, height = 0, channels = 1;
  std::vector<float> pixels;

  Image() = default;
  Image(size_t width_, size_t height_, size_t channels_)
      : width(width_), height(height_), channels(channels_), pixels(width_ * height_ * channels_) {}
  bool operator==(const Image&) const = default;
};

/// The same with 8 bits per sample, for pictures made to be looked at.
struct ByteImage {
  size_t width = 0, height = 0, channels = 1;
  std::vector<uint8_t> pixels;

  ByteImage() = default;
  ByteImage(size_t width_, size_t height_, size_t channels_)
      : width(width_), height(height_), channels(channels_), pixels(width_ * height_ * channels_) {}
  bool operator==(const ByteImage&) const = default;
};

enum class PngDepth { k8, k16 };

/// Full-range grey of a colour, ITU-R BT.601: 0.299 red + 0.587 green + 0.114 blue. A colour without saturation keeps
/// its value exactly.
[[nodiscard]] inline float grey_of(float red, float green, float blue) {
  return green + 0.299F * (red - green) + 0.114F * (blue - green);
}

/// The grey image of a colour image; a grey one comes back as it is.
[[nodiscard]] Image to_grey(Image image);

/// round(255 * clamp(value)); NaN becomes 0.
[[nodiscard]] ByteImage to_bytes(const Image& image);

/// Decodes a PNG (any depth, grey, colour or palette; alpha is dropped; no gamma is applied) or a JPEG (grey or colour)
/// in memory; samples are divided by the largest one of their depth. `name` is the location in errors. Fails with
/// kFormat (neither format, damaged), kTruncated, kUnsupported (a CMYK JPEG). An image that claims more pixels than its
/// bytes can hold is refused before anything is allocated for it.
[[nodiscard]] Result<Image> decode_image(std::span<const uint8_t> bytes, const std::string& name);

/// decode_image of a file; the kind is told by its bytes, not its name. Also fails with kNotFound and kIo.
[[nodiscard]] Result<Image> read_image(const std::filesystem::path& path);

/// Encodes a PNG with little compression: speed first. 16 bits are round(65535 * clamp(value)). Fails with kInternal
/// when libpng does.
/// `view_grid` is kept as text: what a lenslet mosaic says of its views, "8x8".
[[nodiscard]] Result<std::vector<uint8_t>> encode_png(const Image& image, PngDepth depth,
                                                      const std::string& view_grid = {});
[[nodiscard]] Result<std::vector<uint8_t>> encode_png(const ByteImage& image);

/// encode_png into a file that appears whole or not at all. Fails with kIo.
[[nodiscard]] Result<void> write_png(const std::filesystem::path& path, const Image& image,
                                     PngDepth depth = PngDepth::k8, const std::string& view_grid = {});
[[nodiscard]] Result<void> write_png(const std::filesystem::path& path, const ByteImage& image);

}  // namespace e2lf::lightfield
