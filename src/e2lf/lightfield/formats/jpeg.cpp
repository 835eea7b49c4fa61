// SPDX-License-Identifier: MIT
// Decodes JPEG images; declared in raw_image.h.
#include <csetjmp>
#include <cstdio>
// jpeglib.h needs size_t and FILE to be declared first.
#include <jerror.h>
#include <jpeglib.h>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/formats/raw_image.h"

namespace e2lf::lightfield {
namespace {

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

/// As in png.cpp, functions with setjmp hold no objects with destructors.
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
    if (errors_.ended) return {ErrorCode::kTruncated, "the JPEG ends before its image does; copy it again", name};
    return {ErrorCode::kFormat, cat("damaged JPEG (", errors_.message, "); copy it again"), name};
  }

 private:
  jpeg_decompress_struct codec_{};
  JpegErrors errors_;
};

}  // namespace

bool is_jpeg(std::span<const uint8_t> bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

Result<RawImage> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name) {
  RawImage image;
  JpegReader reader;
  if (!reader.read_header(bytes, image)) return reader.error(name);
  if (reader.is_cmyk()) return Error{ErrorCode::kUnsupported, "a CMYK JPEG; convert it to RGB or PNG", name};
  const double pixels = static_cast<double>(image.width) * static_cast<double>(image.height);
  E2LF_RETURN_IF_ERROR(check_image_size(image, pixels / kMaxPixelsPerByte, bytes.size(), name));
  image.samples.resize(image.height * image.row_bytes());
  if (!reader.read_rows(image)) return reader.error(name);
  return image;
}

}  // namespace e2lf::lightfield
