// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/image.h"

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <limits>
#include <png.h>
#include <string_view>
#include <zlib.h>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/formats/readers.h"

// jpeglib.h needs size_t and FILE to be declared first.
#include <jerror.h>
#include <jpeglib.h>

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

/// Rejects an image size that the file cannot hold, where `least_bytes` is the smallest file size that it needs, and
/// sizes beyond 2^28 pixels. It is called before memory is allocated for the pixels.
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

// A block of 8x8 pixels takes at least one bit.
constexpr double kMaxPixelsPerByte = 8.0 * 64.0;

struct JpegErrors {
  jpeg_error_mgr manager{};
  std::jmp_buf jump{};
  char message[JMSG_LENGTH_MAX] = "";
  bool damaged = false;  ///< a warning that means lost pixels
  bool ended = false;
};

void on_error(j_common_ptr codec) {
  auto* errors = reinterpret_cast<JpegErrors*>(codec->err);
  if (codec->err->msg_code == JERR_INPUT_EMPTY) errors->ended = true;
  (*codec->err->format_message)(codec, errors->message);
  std::longjmp(errors->jump, 1);
}

void on_message(j_common_ptr codec, int level) {
  if (level >= 0) return;
  auto* errors = reinterpret_cast<JpegErrors*>(codec->err);
  const int code = codec->err->msg_code;
  const bool ended = code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER;
  if (!ended && code != JWRN_HUFF_BAD_CODE && code != JWRN_MUST_RESYNC) return;
  if (!errors->damaged) (*codec->err->format_message)(codec, errors->message);
  errors->damaged = true;
  errors->ended = errors->ended || ended;
}

/// libjpeg and libpng report errors by longjmp. Functions that call setjmp here therefore hold no objects with
/// destructors; resources belong to the readers and the writer, which live one frame further out.
class JpegReader {
 public:
  JpegReader() {
    codec_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = on_error;
    errors_.manager.emit_message = on_message;
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&codec_); }

  bool read_header(std::span<const uint8_t> bytes, RawImage& image) {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_create_decompress(&codec_);
    jpeg_mem_src(&codec_, bytes.data(), bytes.size());
    jpeg_read_header(&codec_, TRUE);
    image.width = codec_.image_width;
    image.height = codec_.image_height;
    image.channels = codec_.jpeg_color_space == JCS_GRAYSCALE ? 1 : 3;
    codec_.out_color_space = image.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    return true;
  }

  [[nodiscard]] bool is_cmyk() const { return codec_.num_components == 4; }

  bool read_rows(RawImage& image) {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_start_decompress(&codec_);
    while (codec_.output_scanline < codec_.output_height) {
      JSAMPROW row = image.samples.data() + codec_.output_scanline * image.row_bytes();
      jpeg_read_scanlines(&codec_, &row, 1);
    }
    jpeg_finish_decompress(&codec_);
    return !errors_.damaged;
  }

  [[nodiscard]] Error error(const std::string& name) const {
    if (errors_.ended) return fail(ErrorCode::kTruncated, name, "the JPEG ends before its image does; copy it again");
    return fail(ErrorCode::kFormat, name, "damaged JPEG (", errors_.message, "); copy it again");
  }

 private:
  jpeg_decompress_struct codec_{};
  JpegErrors errors_;
};

Result<RawImage> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name) {
  RawImage image;
  JpegReader reader;
  if (!reader.read_header(bytes, image)) return reader.error(name);
  if (reader.is_cmyk()) return fail(ErrorCode::kUnsupported, name, "a CMYK JPEG; convert it to RGB or PNG");
  const double pixels = static_cast<double>(image.width) * static_cast<double>(image.height);
  E2LF_RETURN_IF_ERROR(check_image_size(image, pixels / kMaxPixelsPerByte, bytes.size(), name));
  image.samples.resize(image.height * image.row_bytes());
  if (!reader.read_rows(image)) return reader.error(name);
  return image;
}

constexpr size_t kSignatureBytes = 8;
// Deflate cannot compress by more than a factor of 1032.
constexpr double kMaxDeflateRatio = 1032.0;

struct PngFailure {
  std::string message;
  bool ended = false;  ///< the data ended early
};

void on_error(png_structp png, png_const_charp message) {
  static_cast<PngFailure*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}

class PngReader {
 public:
  explicit PngReader(std::span<const uint8_t> bytes) : rest_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure_, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  /// Reads the part before the pixels and sets up their conversion to 8 or 16 bits, grey or colour.
  bool read_header(RawImage& image) {
    if (png_ == nullptr || info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    // Texts, profiles and the like are not read, so that no memory is allocated as they claim.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_read_fn(png_, this, read_bytes);
    png_read_info(png_, info_);
    image.width = png_get_image_width(png_, info_);
    image.height = png_get_image_height(png_, info_);
    stored_bytes_ = static_cast<double>(png_get_rowbytes(png_, info_)) * static_cast<double>(image.height);
    png_set_expand(png_);
    png_set_strip_alpha(png_);
    if (std::endian::native == std::endian::little) png_set_swap(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    image.channels = png_get_channels(png_, info_);
    image.sample_bytes = png_get_bit_depth(png_, info_) == 16 ? 2 : 1;
    return true;
  }

  bool read_rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  /// Returns the uncompressed size of the rows.
  [[nodiscard]] double stored_bytes() const { return stored_bytes_; }

  [[nodiscard]] Error error(const std::string& name) const {
    if (failure_.ended) return fail(ErrorCode::kTruncated, name, "the PNG ends before its image does; copy it again");
    return fail(ErrorCode::kFormat, name, "damaged PNG (", failure_.message, "); copy it again");
  }

 private:
  static void read_bytes(png_structp png, png_bytep out, size_t count) {
    auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader->rest_.size()) {
      reader->failure_.ended = true;
      png_error(png, "end of data");
    }
    std::memcpy(out, reader->rest_.data(), count);
    reader->rest_ = reader->rest_.subspan(count);
  }

  std::span<const uint8_t> rest_;
  double stored_bytes_ = 0.0;
  PngFailure failure_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

class PngWriter {
 public:
  PngWriter() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure_, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }

  bool write(const RawImage& image, bool is_bilevel, png_bytepp rows) {
    if (png_ == nullptr || info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(png_, &bytes, write_bytes, flush);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
                 is_bilevel ? 1 : static_cast<int>(8 * image.sample_bytes),
                 image.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, is_bilevel ? PNG_FILTER_NONE : PNG_FILTER_SUB);
    png_set_compression_level(png_, 1);
    // After a difference filter, matches are rare in natural images, and searching for them dominates the time.
    png_set_compression_strategy(png_, Z_HUFFMAN_ONLY);
    png_set_compression_buffer_size(png_, size_t{1} << 18);
    png_write_info(png_, info_);
    if (is_bilevel) png_set_packing(png_);
    if (std::endian::native == std::endian::little) png_set_swap(png_);
    png_write_image(png_, rows);
    png_write_end(png_, nullptr);
    return true;
  }

  [[nodiscard]] Error error() const {
    return fail(ErrorCode::kInternal, "", "libpng could not encode an image (", failure_.message, "); check its size");
  }

  std::vector<uint8_t> bytes;

 private:
  static void write_bytes(png_structp png, png_bytep data, size_t count) {
    auto* out = static_cast<std::vector<uint8_t>*>(png_get_io_ptr(png));
    out->insert(out->end(), data, data + count);
  }
  static void flush(png_structp /*png*/) {}

  PngFailure failure_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

/// libpng takes rows as mutable pointers even if it only reads them.
std::vector<png_bytep> row_pointers(const RawImage& image) {
  std::vector<png_bytep> rows(image.height);
  for (size_t y = 0; y < image.height; ++y) {
    rows[y] = const_cast<png_bytep>(image.samples.data() + y * image.row_bytes());
  }
  return rows;
}

Result<RawImage> decode_png(std::span<const uint8_t> bytes, const std::string& name) {
  RawImage image;
  PngReader reader(bytes);
  if (!reader.read_header(image)) return reader.error(name);
  E2LF_RETURN_IF_ERROR(check_image_size(image, reader.stored_bytes() / kMaxDeflateRatio, bytes.size(), name));
  image.samples.resize(image.height * image.row_bytes());
  std::vector<png_bytep> rows = row_pointers(image);
  if (!reader.read_rows(rows.data())) return reader.error(name);
  return image;
}

/// Compresses the rows of `image`. A bilevel PNG has 1 bit per pixel, and its samples are 0 and 1.
Result<std::vector<uint8_t>> encode_png_rows(const RawImage& image, bool is_bilevel = false) {
  PngWriter writer;
  writer.bytes.reserve(image.samples.size() / 2 + 1024);
  std::vector<png_bytep> rows = row_pointers(image);
  if (!writer.write(image, is_bilevel, rows.data())) return writer.error();
  return std::move(writer.bytes);
}

}  // namespace

bool is_jpeg(std::span<const uint8_t> bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

bool is_png(std::span<const uint8_t> bytes) {
  return bytes.size() >= kSignatureBytes && png_sig_cmp(bytes.data(), 0, kSignatureBytes) == 0;
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
