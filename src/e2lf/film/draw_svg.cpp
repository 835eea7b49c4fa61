// SPDX-License-Identifier: MIT
#include "e2lf/film/draw_svg.h"

#include "e2lf/base/text.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include <cstring>
#include <memory>

namespace e2lf::film {
namespace {

struct Free {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};

Error unreadable() {
  return {ErrorCode::kFormat, "the drawing cannot be rendered to an image; write it as .svg", ""};
}

lightfield::Image image_of(const AVFrame& frame) {
  lightfield::Image image(static_cast<size_t>(frame.width), static_cast<size_t>(frame.height), 3);
  float* pixel = image.pixels.data();
  for (int y = 0; y < frame.height; ++y) {
    const uint8_t* row = frame.data[0] + static_cast<ptrdiff_t>(y) * frame.linesize[0];
    for (int x = 0; x < frame.width; ++x) {
      uint32_t argb = 0;
      std::memcpy(&argb, row + 4 * static_cast<ptrdiff_t>(x), sizeof argb);
      for (const int shift : {16, 8, 0}) *pixel++ = static_cast<float>(argb >> shift & 0xFFU) / 255.0F;
    }
  }
  return image;
}

}  // namespace

Result<lightfield::Image> draw_svg(const std::string& svg, size_t width) {
  const AVCodec* const decoder = avcodec_find_decoder(AV_CODEC_ID_SVG);
  if (decoder == nullptr) {
    return fail(ErrorCode::kMissingDependency, "", "this build of FFmpeg cannot render SVG; write the chart as .svg");
  }
  const std::unique_ptr<AVCodecContext, Free> context(avcodec_alloc_context3(decoder));
  const std::unique_ptr<AVPacket, Free> packet(av_packet_alloc());
  const std::unique_ptr<AVFrame, Free> frame(av_frame_alloc());
  if (!context || !packet || !frame || av_new_packet(packet.get(), static_cast<int>(svg.size())) < 0) {
    return fail(ErrorCode::kInternal, "", "there is not enough memory to render the chart");
  }
  std::memcpy(packet->data, svg.data(), svg.size());
  av_opt_set_int(context->priv_data, "width", static_cast<int64_t>(width), 0);
  if (avcodec_open2(context.get(), decoder, nullptr) < 0 || avcodec_send_packet(context.get(), packet.get()) < 0 ||
      avcodec_receive_frame(context.get(), frame.get()) < 0 || frame->format != AV_PIX_FMT_RGB32) {
    return unreadable();
  }
  return image_of(*frame);
}

}  // namespace e2lf::film
