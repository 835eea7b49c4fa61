// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/image.h"

#include <limits>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

/// Clamps to [0, 1]; NaN becomes 0.
float clamp_unit(float value) {
  return value > 0.0F ? (value < 1.0F ? value : 1.0F) : 0.0F;
}

/// Returns the size of an image to write, without its samples.
template <typename T>
RawImage raw_of(const BasicImage<T>& image, size_t sample_bytes) {
  const size_t width = image.width, height = image.height, channels = image.channels;
  E2LF_REQUIRE(width > 0 && height > 0 && (channels == 1 || channels == 3), "an image to write has pixels");
  E2LF_REQUIRE(image.pixels.size() == width * height * channels, "the pixels of an image must fill its size");
  return {width, height, channels, sample_bytes, {}};
}

/// Stores the values as samples round(largest * clamp(value)).
template <typename T>
void quantise(std::span<const float> values, uint8_t* out) {
  constexpr auto kLargest = static_cast<float>(std::numeric_limits<T>::max());
  for (size_t i = 0; i < values.size(); ++i) {
    store_le(out + i * sizeof(T), static_cast<T>(static_cast<int>(kLargest * clamp_unit(values[i]) + 0.5F)));
  }
}

}  // namespace

Result<void> check_image_size(const RawImage& image, double least_bytes, size_t file_bytes, const std::string& name) {
  constexpr double kMaxPixels = 268435456.0;
  const double pixels = static_cast<double>(image.width) * static_cast<double>(image.height);
  if (least_bytes > static_cast<double>(file_bytes)) {
    return fail(ErrorCode::kTruncated, name, "the header states ", image.width, "x", image.height,
                " pixels, which is more than the ", file_bytes, " bytes of the file can contain; copy the file again");
  }
  if (pixels <= kMaxPixels) return {};
  return fail(ErrorCode::kUnsupported, name, "the image has ", image.width, "x", image.height,
              " pixels, but at most 2^28 are supported; split it into parts");
}

Result<RawImage> decode_raw_image(std::span<const uint8_t> bytes, const std::string& name) {
  if (is_png(bytes)) return decode_png(bytes, name);
  if (is_jpeg(bytes)) return decode_jpeg(bytes, name);
  if (bytes.empty()) return fail(ErrorCode::kFormat, name, "the file is empty; copy it again");
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("version https://git-lfs")) {
    return fail(ErrorCode::kFormat, name,
                "the file is a Git LFS pointer instead of an image; fetch the image with `git lfs pull`");
  }
  return fail(ErrorCode::kFormat, name, "the file is neither a PNG nor a JPEG image; convert it to PNG");
}

Image to_grey(Image image) {
  if (image.channels == 1) return image;
  Image grey(image.width, image.height, 1);
  for (size_t i = 0; i < grey.pixels.size(); ++i) {
    const float* pixel = image.pixels.data() + 3 * i;
    grey.pixels[i] = grey_of(pixel[0], pixel[1], pixel[2]);
  }
  return grey;
}

ByteImage to_bytes(const Image& image) {
  ByteImage bytes(image.width, image.height, image.channels);
  quantise<uint8_t>(image.pixels, bytes.pixels.data());
  return bytes;
}

Result<Image> decode_image(std::span<const uint8_t> bytes, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const RawImage raw, decode_raw_image(bytes, name));
  const bool is_byte = raw.sample_bytes == 1;
  Image image(raw.width, raw.height, raw.channels);
  E2LF_ASSIGN_OR_RETURN(image.pixels, elements_to_float(is_byte ? "u1" : "u2", raw.samples, name));
  for (float& value : image.pixels) value /= is_byte ? 255.0F : 65535.0F;
  return image;
}

Result<Image> read_image(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  return decode_image(bytes, path.string());
}

Result<std::vector<uint8_t>> encode_png(const Image& image, PngDepth depth) {
  RawImage raw = raw_of(image, depth == PngDepth::k16 ? 2 : 1);
  raw.samples.resize(image.pixels.size() * raw.sample_bytes);
  (depth == PngDepth::k16 ? quantise<uint16_t> : quantise<uint8_t>)(image.pixels, raw.samples.data());
  return encode_png_rows(raw);
}

Result<std::vector<uint8_t>> encode_png(const ByteImage& image) {
  RawImage raw = raw_of(image, 1);
  raw.samples = image.pixels;
  return encode_png_rows(raw);
}

Result<void> write_png(const std::filesystem::path& path, const Image& image, PngDepth depth) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, encode_png(image, depth));
  return write_file(path, bytes);
}

Result<void> write_png(const std::filesystem::path& path, const ByteImage& image) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, encode_png(image));
  return write_file(path, bytes);
}

Result<std::vector<uint8_t>> encode_bilevel_png(const ByteImage& image) {
  E2LF_REQUIRE(image.channels == 1, "the picture is grey");
  RawImage raw = raw_of(image, 1);
  for (const uint8_t value : image.pixels) raw.samples.push_back(value >= 128 ? 1 : 0);
  return encode_png_rows(raw, /*is_bilevel=*/true);
}

}  // namespace e2lf::lightfield
