// SPDX-License-Identifier: MIT
#include "e2lf/film/film_file.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>

namespace e2lf::film {
namespace {

using lightfield::Image;

struct Recipe {
  const char* container;
  std::array<AVCodecID, 2> codecs;  ///< the first one with an available encoder is used
  const char* quality;              ///< the constant rate factor
};

/// By FilmFormat.
constexpr Recipe kRecipes[] = {{"gif", {AV_CODEC_ID_GIF, AV_CODEC_ID_NONE}, nullptr},
                               {"webm", {AV_CODEC_ID_VP9, AV_CODEC_ID_VP8}, "20"},
                               {"mp4", {AV_CODEC_ID_H264, AV_CODEC_ID_MPEG4}, "18"}};

const AVCodec* encoder_of(const Recipe& recipe) {
  for (AVCodecID id : recipe.codecs) {
    if (const AVCodec* encoder = avcodec_find_encoder(id)) return encoder;
  }
  return nullptr;
}

AVPixelFormat pixels_of(FilmFormat format, bool has_colour) {
  if (format != FilmFormat::kGif) return AV_PIX_FMT_YUV420P;
  return has_colour ? AV_PIX_FMT_RGB8 : AV_PIX_FMT_GRAY8;
}

struct FfmpegFilm {
  std::string name;
  size_t width, height, channels;  ///< of the frames given
  AVFormatContext* container = nullptr;
  AVCodecContext* encoder = nullptr;
  AVStream* stream = nullptr;
  SwsContext* converter = nullptr;
  AVFrame* frame = nullptr;
  AVPacket* packet = nullptr;
  int64_t frames = 0;  ///< added so far

  FfmpegFilm(std::string name_, const Image& first)
      : name(std::move(name_)), width(first.width), height(first.height), channels(first.channels) {}
  FfmpegFilm(const FfmpegFilm&) = delete;
  FfmpegFilm& operator=(const FfmpegFilm&) = delete;
  ~FfmpegFilm() {
    av_packet_free(&packet);
    av_frame_free(&frame);
    sws_freeContext(converter);
    avcodec_free_context(&encoder);
    if (container != nullptr) avio_closep(&container->pb);
    avformat_free_context(container);
  }

  [[nodiscard]] Result<void> check(int code, const char* what, ErrorCode kind = ErrorCode::kInternal) const {
    if (code >= 0) return {};
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return Error{kind, cat("FFmpeg cannot ", what, " (", text.data(), "); free some disk space or use another format"),
                 name};
  }

  Result<void> open(FilmFormat format, int frames_per_s) {
    const Recipe& recipe = kRecipes[static_cast<size_t>(format)];
    const AVCodec* const codec = encoder_of(recipe);
    if (codec == nullptr) {
      return fail(ErrorCode::kMissingDependency, name, "this build of FFmpeg has no encoder for ", recipe.container,
                  "; write a .gif");
    }
    E2LF_RETURN_IF_ERROR(check(avformat_alloc_output_context2(&container, nullptr, recipe.container, name.c_str()),
                               "make this container"));
    encoder = avcodec_alloc_context3(codec);
    stream = avformat_new_stream(container, nullptr);
    frame = av_frame_alloc();
    packet = av_packet_alloc();
    if (encoder == nullptr || stream == nullptr || frame == nullptr || packet == nullptr) {
      return check(AVERROR(ENOMEM), "begin");
    }
    set_up(format, frames_per_s, recipe);
    E2LF_RETURN_IF_ERROR(check(avcodec_open2(encoder, codec, nullptr), "open the encoder"));
    E2LF_RETURN_IF_ERROR(
        check(avcodec_parameters_from_context(stream->codecpar, encoder), "describe the film in its file"));
    E2LF_RETURN_IF_ERROR(check(avio_open(&container->pb, name.c_str(), AVIO_FLAG_WRITE), "write", ErrorCode::kIo));
    E2LF_RETURN_IF_ERROR(check(avformat_write_header(container, nullptr), "write", ErrorCode::kIo));
    return make_converter();
  }

  void set_up(FilmFormat format, int frames_per_s, const Recipe& recipe) const {
    const bool is_even = format != FilmFormat::kGif;
    encoder->width = static_cast<int>(is_even ? width & ~size_t{1} : width);
    encoder->height = static_cast<int>(is_even ? height & ~size_t{1} : height);
    encoder->time_base = {1, frames_per_s};
    encoder->framerate = {frames_per_s, 1};
    encoder->pix_fmt = pixels_of(format, channels == 3);
    // The same frames give the same file, so it contains no version.
    encoder->flags |= AV_CODEC_FLAG_BITEXACT;
    container->flags |= AVFMT_FLAG_BITEXACT;
    if ((container->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // Encoders ignore options that they do not know.
    if (recipe.quality != nullptr) av_opt_set(encoder->priv_data, "crf", recipe.quality, 0);
    av_opt_set(encoder->priv_data, "cpu-used", "4", 0);
    stream->time_base = encoder->time_base;
  }

  Result<void> make_converter() {
    const AVPixelFormat from = channels == 3 ? AV_PIX_FMT_RGB24 : AV_PIX_FMT_GRAY8;
    converter = sws_getContext(encoder->width, encoder->height, from, encoder->width, encoder->height, encoder->pix_fmt,
                               SWS_BICUBIC, nullptr, nullptr, nullptr);
    if (converter == nullptr) return check(AVERROR(ENOMEM), "convert pictures");
    frame->format = encoder->pix_fmt;
    frame->width = encoder->width;
    frame->height = encoder->height;
    return check(av_frame_get_buffer(frame, 0), "hold a picture");
  }

  /// Sends a frame, or nullptr at the end, and writes the packets that are ready.
  Result<void> encode(const AVFrame* input) const {
    E2LF_RETURN_IF_ERROR(check(avcodec_send_frame(encoder, input), "encode"));
    for (;;) {
      const int code = avcodec_receive_packet(encoder, packet);
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
      E2LF_RETURN_IF_ERROR(check(code, "encode"));
      packet->duration = 1;
      av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
      packet->stream_index = stream->index;
      E2LF_RETURN_IF_ERROR(check(av_interleaved_write_frame(container, packet), "write", ErrorCode::kIo));
    }
  }

  Result<void> add(const Image& image) {
    E2LF_REQUIRE(image.width == width && image.height == height && image.channels == channels,
                 "all frames have one size");
    const lightfield::ByteImage bytes = lightfield::to_bytes(image);
    E2LF_RETURN_IF_ERROR(check(av_frame_make_writable(frame), "hold a picture"));
    const uint8_t* const source = bytes.pixels.data();
    const int stride = static_cast<int>(width * channels);
    sws_scale(converter, &source, &stride, 0, encoder->height, frame->data, frame->linesize);
    frame->pts = frames++;
    return encode(frame);
  }

  Result<void> finish() {
    E2LF_RETURN_IF_ERROR(encode(nullptr));
    E2LF_RETURN_IF_ERROR(check(av_write_trailer(container), "write", ErrorCode::kIo));
    return check(avio_closep(&container->pb), "write", ErrorCode::kIo);
  }
};

}  // namespace

Result<void> check_film_support() {
  return {};
}

Result<void> write_film(const std::filesystem::path& path, FilmFormat format, const Film& film,
                        const ProgressFn& progress) {
  E2LF_REQUIRE(film.frames_per_s >= 1 && film.frames_per_s <= 100, "the frame rate must be 1 to 100 Hz");
  const Image first = film.frame_at(0);
  if (first.width < 2 || first.height < 2 || first.width > 16384 || first.height > 16384) {
    return fail(ErrorCode::kUnsupported, path, "a film cannot have ", first.width, "x", first.height,
                " px; use 2 to 16384 px in each direction");
  }
  av_log_set_level(AV_LOG_QUIET);
  FfmpegFilm file(path.string(), first);
  E2LF_RETURN_IF_ERROR(file.open(format, film.frames_per_s));
  for (size_t frame = 0; frame < film.frames; ++frame) {
    E2LF_RETURN_IF_ERROR(file.add(frame == 0 ? first : film.frame_at(frame)));
    if (progress) progress(frame + 1, film.frames);
  }
  return file.finish();
}

}  // namespace e2lf::film
