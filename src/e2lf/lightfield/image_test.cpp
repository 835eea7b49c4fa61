// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/image.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include "e2lf/files/file.h"
#include "testing/test_files.h"
#include "testing/test_jpeg.h"

namespace e2lf::lightfield {
namespace {

using testing::HasSubstr;

Image gradient(size_t width, size_t height, size_t channels, float levels) {
  Image image(width, height, channels);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = std::floor(std::fmod(static_cast<float>(i) * 37.0F, levels + 1.0F)) / levels;
  }
  return image;
}

/// What a PNG is made of, for kinds that encode_png does not write.
struct PngParts {
  int width = 0, height = 0, depth = 8, color_type = PNG_COLOR_TYPE_GRAY, interlace = PNG_INTERLACE_NONE;
  std::vector<png_color> palette{};
  std::vector<png_byte> palette_alpha{};
  std::vector<uint8_t> rows{};  ///< packed as PNG stores them
};

std::vector<uint8_t> make_png(PngParts parts) {
  std::vector<uint8_t> bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp writer, png_bytep data, size_t count) {
        auto* out = static_cast<std::vector<uint8_t>*>(png_get_io_ptr(writer));
        out->insert(out->end(), data, data + count);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(parts.width), static_cast<png_uint_32>(parts.height), parts.depth,
               parts.color_type, parts.interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!parts.palette.empty()) {
    png_set_PLTE(png, info, parts.palette.data(), static_cast<int>(parts.palette.size()));
  }
  if (!parts.palette_alpha.empty()) {
    png_set_tRNS(png, info, parts.palette_alpha.data(), static_cast<int>(parts.palette_alpha.size()), nullptr);
  }
  png_write_info(png, info);
  std::vector<png_bytep> rows;
  const size_t row_bytes = png_get_rowbytes(png, info);
  for (size_t y = 0; y < static_cast<size_t>(parts.height); ++y) rows.push_back(parts.rows.data() + y * row_bytes);
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

TEST(Png, RoundTripsExactlyAtBothDepthsGreyAndColour) {
  for (const size_t channels : {1, 3}) {
    const Image image8 = gradient(33, 17, channels, 255.0F);
    const Image image16 = gradient(33, 17, channels, 65535.0F);
    EXPECT_EQ(decode_image(encode_png(image8, PngDepth::k8).value(), "a").value(), image8);
    EXPECT_EQ(decode_image(encode_png(image16, PngDepth::k16).value(), "a").value(), image16);
  }
}

TEST(Png, WritesRoundedClampedValues) {
  Image image(6, 1, 1);
  image.pixels = {-0.5F, 0.4999F / 255.0F, 0.5001F / 255.0F, 254.6F / 255.0F, 7.0F, std::nanf("")};
  EXPECT_EQ(to_bytes(image).pixels, (std::vector<uint8_t>{0, 0, 1, 255, 255, 0}));
  const Image back = decode_image(encode_png(image, PngDepth::k8).value(), "a").value();
  EXPECT_EQ(to_bytes(back).pixels, to_bytes(image).pixels);
  const Image fine = decode_image(encode_png(image, PngDepth::k16).value(), "a").value();
  EXPECT_EQ(fine.pixels[0], 0.0F);
  EXPECT_NEAR(fine.pixels[1], image.pixels[1], 0.5001F / 65535.0F);
  EXPECT_EQ(fine.pixels[4], 1.0F);
  EXPECT_EQ(fine.pixels[5], 0.0F);
}

TEST(Png, ReadsAFileWrittenAsBytes) {
  TestFolder folder;
  ByteImage image(5, 4, 3);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<uint8_t>(4 * i);
  ASSERT_TRUE(write_png(folder / "a.png", image).ok());
  EXPECT_EQ(to_bytes(read_image(folder / "a.png").value()), image);
}

TEST(Png, ReadsPalettesAndDropsTheirAlpha) {
  PngParts parts{.width = 3, .height = 1, .depth = 2, .color_type = PNG_COLOR_TYPE_PALETTE};
  parts.palette = {{255, 0, 0}, {0, 51, 0}, {0, 0, 102}};
  parts.palette_alpha = {0, 128, 255};
  parts.rows = {0b00'01'10'00};
  const Image image = decode_image(make_png(parts), "a").value();
  EXPECT_EQ(image.channels, 3U);
  EXPECT_THAT(image.pixels, testing::ElementsAre(1.0F, 0, 0, 0, 0.2F, 0, 0, 0, 0.4F));
}

TEST(Png, DropsAlphaWithoutBlending) {
  PngParts parts{.width = 2, .height = 1, .depth = 8, .color_type = PNG_COLOR_TYPE_RGB_ALPHA};
  parts.rows = {51, 102, 153, 0, 204, 255, 0, 7};
  EXPECT_THAT(decode_image(make_png(parts), "a").value().pixels, testing::ElementsAre(0.2F, 0.4F, 0.6F, 0.8F, 1.0F, 0));
  PngParts grey{.width = 1, .height = 1, .depth = 16, .color_type = PNG_COLOR_TYPE_GRAY_ALPHA};
  grey.rows = {0x12, 0x34, 0, 0};
  EXPECT_THAT(decode_image(make_png(grey), "a").value().pixels, testing::ElementsAre(0x1234 / 65535.0F));
}

TEST(Png, ReadsFewBitsAndInterlacedRows) {
  PngParts bits{.width = 4, .height = 2, .depth = 1};
  bits.rows = {0b1010'0000, 0b0110'0000};
  EXPECT_THAT(decode_image(make_png(bits), "a").value().pixels, testing::ElementsAre(1, 0, 1, 0, 0, 1, 1, 0));
  PngParts woven{.width = 9, .height = 7};
  woven.interlace = PNG_INTERLACE_ADAM7;
  for (int i = 0; i < 63; ++i) woven.rows.push_back(static_cast<uint8_t>(4 * i));
  EXPECT_EQ(to_bytes(decode_image(make_png(woven), "a").value()).pixels, woven.rows);
}

TEST(Png, EveryTruncationIsAnErrorThatNamesTheFile) {
  const std::vector<uint8_t> whole = encode_png(gradient(20, 20, 1, 255.0F), PngDepth::k8).value();
  for (size_t size = 8; size < whole.size(); ++size) {
    const Result<Image> image = decode_image(std::span(whole).first(size), "views/03_04.png");
    ASSERT_FALSE(image.ok()) << size;
    EXPECT_EQ(image.error().code, ErrorCode::kTruncated) << size << ": " << image.error().text();
    EXPECT_EQ(image.error().location, "views/03_04.png");
  }
}

TEST(Png, DamageAndGarbageAreFormatErrors) {
  std::vector<uint8_t> bytes = encode_png(gradient(20, 20, 1, 255.0F), PngDepth::k8).value();
  bytes[60] ^= 0x55;
  EXPECT_EQ(decode_image(bytes, "a").error().code, ErrorCode::kFormat);
  const std::vector<uint8_t> garbage(100, 0x42);
  EXPECT_EQ(decode_image(garbage, "a").error().code, ErrorCode::kFormat);
  EXPECT_EQ(decode_image({}, "a").error().code, ErrorCode::kFormat);
}

/// Returns a PNG of 4x4 pixels that claims another size.
std::vector<uint8_t> png_that_claims(uint32_t width, uint32_t height) {
  std::vector<uint8_t> bytes = encode_png(Image(4, 4, 1), PngDepth::k8).value();
  const auto put = [&bytes](size_t at, uint32_t value) {
    for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<uint8_t>(value >> (24 - 8 * i));
  };
  put(16, width);
  put(20, height);
  put(29, static_cast<uint32_t>(crc32(0, bytes.data() + 12, 17)));
  return bytes;
}

TEST(Png, ASizeBeyondTheFileIsRefusedBeforeAllocation) {
  const Error error = decode_image(png_that_claims(1'000'000, 1'000'000), "big.png").error();
  EXPECT_EQ(error.code, ErrorCode::kTruncated) << error.text();
  EXPECT_THAT(error.text(), HasSubstr("1000000x1000000"));
}

TEST(Png, ASizeIsBoundedWhateverTheFileHolds) {
  std::vector<uint8_t> bytes = png_that_claims(16385, 16384);
  bytes.resize(size_t{1} << 19);
  EXPECT_EQ(decode_image(bytes, "a").error().code, ErrorCode::kUnsupported);
}

TEST(Png, AWriteUnderARegularFileIsAnIoError) {
  TestFolder folder;
  ASSERT_TRUE(write_file(folder / "file", std::string("text")).ok());
  EXPECT_EQ(write_png(folder / "file/a.png", Image(2, 2, 1)).error().code, ErrorCode::kIo);
}

TEST(Jpeg, ReadsGreyAndColour) {
  const std::vector<uint8_t> grey(16 * 8, 200);
  const Image one = decode_image(make_jpeg(grey, 16, 8, 1, JCS_GRAYSCALE), "a").value();
  EXPECT_EQ(one, Image([] {
              Image flat(16, 8, 1);
              std::fill(flat.pixels.begin(), flat.pixels.end(), 200.0F / 255.0F);
              return flat;
            }()));
  std::vector<uint8_t> red;
  for (int i = 0; i < 16 * 8; ++i) red.insert(red.end(), {250, 10, 20});
  const Image three = decode_image(make_jpeg(red, 16, 8, 3, JCS_RGB), "a").value();
  ASSERT_EQ(three.channels, 3U);
  EXPECT_NEAR(three.pixels[30], 250 / 255.0F, 2 / 255.0F);
  EXPECT_NEAR(three.pixels[31], 10 / 255.0F, 2 / 255.0F);
  EXPECT_NEAR(three.pixels[32], 20 / 255.0F, 2 / 255.0F);
}

TEST(Jpeg, TruncatedCmykAndOversizedAreErrors) {
  std::vector<uint8_t> samples(64 * 64);
  for (size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<uint8_t>(i * 31);
  std::vector<uint8_t> bytes = make_jpeg(samples, 64, 64, 1, JCS_GRAYSCALE);
  for (const size_t size : {size_t{3}, size_t{50}, bytes.size() / 2, bytes.size() - 2}) {
    const Result<Image> image = decode_image(std::span(bytes).first(size), "a.jpg");
    ASSERT_FALSE(image.ok()) << size;
    EXPECT_EQ(image.error().code, ErrorCode::kTruncated) << size << image.error().text();
  }
  EXPECT_EQ(decode_image(make_jpeg(samples, 32, 32, 4, JCS_CMYK), "a").error().code, ErrorCode::kUnsupported);
  // Height and width stand in the frame header (marker FFC0), five bytes on.
  for (size_t i = 0; i + 9 < bytes.size(); ++i) {
    if (bytes[i] == 0xFF && bytes[i + 1] == 0xC0) {
      std::fill_n(bytes.begin() + static_cast<long>(i) + 5, 4, uint8_t{0xF0});
      break;
    }
  }
  EXPECT_THAT(decode_image(bytes, "a").error().text(), HasSubstr("61680x61680"));
}

TEST(Grey, IsFullRangeBt601AndKeepsGreyExactly) {
  EXPECT_FLOAT_EQ(grey_of(1, 0, 0), 0.299F);
  EXPECT_FLOAT_EQ(grey_of(0, 1, 0), 0.587F);
  EXPECT_FLOAT_EQ(grey_of(0, 0, 1), 0.114F);
  for (int i = 0; i < 256; ++i) {
    const float value = static_cast<float>(i) / 255.0F;
    EXPECT_EQ(grey_of(value, value, value), value);
  }
  Image image(2, 1, 3);
  image.pixels = {1, 0, 0, 1, 1, 1};
  EXPECT_THAT(to_grey(image).pixels, testing::ElementsAre(testing::FloatEq(0.299F), 1.0F));
  EXPECT_EQ(to_grey(gradient(3, 3, 1, 255.0F)), gradient(3, 3, 1, 255.0F));
}

}  // namespace
}  // namespace e2lf::lightfield
