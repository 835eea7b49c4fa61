// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/formats/bitmap.h"

#include "e2lf/base/contract.h"
#include "e2lf/lightfield/formats/raw_image.h"

namespace e2lf::lightfield {
namespace {

/// Returns row `y` of `image`, padded with zeros to a multiple of `alignment` bytes. At one bit per pixel, a byte holds
/// eight pixels.
std::vector<uint8_t> packed_row(const ByteImage& image, size_t y, BitDepth depth, size_t alignment) {
  const uint8_t* pixels = image.pixels.data() + y * image.width;
  const size_t bytes = depth == BitDepth::k1 ? (image.width + 7) / 8 : image.width;
  std::vector<uint8_t> row((bytes + alignment - 1) / alignment * alignment);
  for (size_t x = 0; x < image.width; ++x) {
    if (depth == BitDepth::k8) {
      row[x] = pixels[x];
    } else if (pixels[x] >= 128) {
      row[x / 8] = static_cast<uint8_t>(row[x / 8] | (0x80U >> (x % 8)));
    }
  }
  return row;
}

void put(std::vector<uint8_t>& bytes, uint32_t value, size_t count) {
  for (size_t i = 0; i < count; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

}  // namespace

Result<std::vector<uint8_t>> encode_grey_png(const ByteImage& image, BitDepth depth) {
  E2LF_REQUIRE(image.channels == 1, "the picture is grey");
  if (depth == BitDepth::k8) return encode_png(image);
  RawImage raw;
  raw.width = image.width;
  raw.height = image.height;
  raw.is_bilevel = true;
  for (size_t y = 0; y < image.height; ++y) {
    const auto row = packed_row(image, y, depth, 1);
    raw.samples.insert(raw.samples.end(), row.begin(), row.end());
  }
  return encode_png_rows(raw);
}

/// Writes a Windows bitmap: file header, BITMAPINFOHEADER, palette of greys, and rows from bottom to top.
std::vector<uint8_t> encode_grey_bmp(const ByteImage& image, BitDepth depth) {
  E2LF_REQUIRE(image.channels == 1, "the picture is grey");
  constexpr uint32_t kHeaders = 14 + 40, kPixelsPerMetre = 3780;
  const uint32_t bits = depth == BitDepth::k1 ? 1 : 8, colours = 1U << bits;
  const auto row_bytes = static_cast<uint32_t>(packed_row(image, 0, depth, 4).size());
  const uint32_t data = row_bytes * static_cast<uint32_t>(image.height), begin = kHeaders + 4 * colours;
  std::vector<uint8_t> bytes = {'B', 'M'};
  put(bytes, begin + data, 4);
  put(bytes, 0, 4);
  put(bytes, begin, 4);
  put(bytes, 40, 4);
  put(bytes, static_cast<uint32_t>(image.width), 4);
  put(bytes, static_cast<uint32_t>(image.height), 4);
  put(bytes, 1, 2);  // planes
  put(bytes, bits, 2);
  put(bytes, 0, 4);  // not compressed
  put(bytes, data, 4);
  put(bytes, kPixelsPerMetre, 4);
  put(bytes, kPixelsPerMetre, 4);
  put(bytes, colours, 4);
  put(bytes, 0, 4);  // all colours are important
  for (uint32_t colour = 0; colour < colours; ++colour) {
    const uint32_t grey = colour * 255 / (colours - 1);
    put(bytes, grey * 0x010101U, 4);
  }
  for (size_t y = image.height; y-- > 0;) {
    const auto row = packed_row(image, y, depth, 4);
    bytes.insert(bytes.end(), row.begin(), row.end());
  }
  return bytes;
}

}  // namespace e2lf::lightfield
