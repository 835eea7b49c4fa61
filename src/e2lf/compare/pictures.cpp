// SPDX-License-Identifier: MIT
#include "e2lf/compare/pictures.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/contract.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/lightfield/contact_sheet.h"
#include "e2lf/lightfield/crop.h"
#include "e2lf/lightfield/epi.h"

namespace e2lf::compare {
namespace {

using lightfield::enlarged;
using lightfield::Image;
using lightfield::LightField;

constexpr size_t kMostWidth = 320, kGap = 4, kRowsPerView = 5;
constexpr float kWhiteError = 0.2F;

Image fitted(const Image& image) {
  if (image.width <= kMostWidth) return image;
  return lightfield::shrink(image, kMostWidth, std::max<size_t>(1, image.height * kMostWidth / image.width));
}

/// Copies an image onto the canvas, converting grey to colour if the canvas has colour.
void paste(const Image& image, size_t top, size_t left, Image& canvas) {
  for (size_t y = 0; y < image.height; ++y) {
    for (size_t x = 0; x < image.width; ++x) {
      const float* from = image.pixels.data() + (y * image.width + x) * image.channels;
      float* to = canvas.pixels.data() + ((top + y) * canvas.width + left + x) * canvas.channels;
      for (size_t c = 0; c < canvas.channels; ++c) to[c] = from[std::min(c, image.channels - 1)];
    }
  }
}

/// Returns the error of the first view, averaged over its colours.
Image error_image(const Image& view, const Image& truth) {
  Image error(view.width, view.height, 1);
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    const float difference = std::abs(std::clamp(view.pixels[i], 0.0F, 1.0F) - truth.pixels[i]);
    error.pixels[i / view.channels] += difference / (kWhiteError * static_cast<float>(view.channels));
  }
  return error;
}

/// Returns the middle of a picture, enlarged and with a white frame. Its sides are at most a third of those of the
/// view.
Image inset_of(const Image& view, const Image& shown) {
  const size_t times = 3;
  const size_t side = std::max<size_t>(1, std::min(shown.width, shown.height) / 3 / times);
  Image part(side, side, view.channels);
  for (size_t y = 0; y < side; ++y) {
    const size_t from = ((view.height - side) / 2 + y) * view.width + (view.width - side) / 2;
    std::copy_n(view.pixels.data() + from * view.channels, side * view.channels,
                part.pixels.data() + y * side * view.channels);
  }
  Image framed(side * times + 2, side * times + 2, view.channels);
  std::fill(framed.pixels.begin(), framed.pixels.end(), 1.0F);
  paste(enlarged(part, times, times), 1, 1, framed);
  return framed;
}

}  // namespace

Image look(const LightField& field, const LightField* truth, const Image& disparity, const Image& true_disparity) {
  E2LF_REQUIRE(truth == nullptr || truth->shape() == field.shape(), "a light field is compared with one of its shape");
  const Image view = lightfield::view_image(field, 0, 0);
  const Image shown = fitted(view);
  const Image epi = lightfield::horizontal_epi(field, 0, field.shape().height / 2);
  const Image strip =
      enlarged(epi.width > shown.width ? lightfield::shrink(epi, shown.width, epi.height) : epi, kRowsPerView, 1);
  const size_t columns = truth == nullptr ? 1 : 2;
  const bool has_disparity = !disparity.pixels.empty();
  const size_t height = shown.height + kGap + strip.height;
  Image canvas(columns * (shown.width + kGap) - kGap, height + (has_disparity ? kGap + shown.height : 0),
               has_disparity ? 3 : field.shape().channels);
  std::fill(canvas.pixels.begin(), canvas.pixels.end(), 0.5F);
  paste(shown, 0, 0, canvas);
  const Image inset = inset_of(view, shown);
  if (inset.width <= shown.width && inset.height <= shown.height) {
    paste(inset, shown.height - inset.height, shown.width - inset.width, canvas);
  }
  paste(strip, shown.height + kGap, 0, canvas);
  if (has_disparity) {
    const Image& shown_fully = true_disparity.pixels.empty() ? disparity : true_disparity;
    paste(fitted(depth::colour_picture(disparity, depth::shown_range(shown_fully))), height + kGap, 0, canvas);
  }
  if (truth == nullptr) return canvas;
  paste(fitted(error_image(view, lightfield::view_image(*truth, 0, 0))), 0, shown.width + kGap, canvas);
  return canvas;
}

}  // namespace e2lf::compare
