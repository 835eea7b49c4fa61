// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/epi.h"

#include <algorithm>
#include <array>

#include "e2lf/lightfield/views.h"

namespace e2lf::lightfield {
namespace {

using Colour = std::array<float, 3>;
constexpr size_t kGapPx = 4;  ///< white space between the parts
constexpr Colour kRowColour{0.16F, 0.39F, 1.0F};
constexpr Colour kColumnColour{0.1F, 0.75F, 0.25F};

/// A rectangle of pixels on a canvas.
struct Box {
  size_t y, x, height, width;
};

void set_pixel(Image& canvas, size_t y, size_t x, const Colour& colour) {
  std::copy(colour.begin(), colour.end(), canvas.pixels.begin() + static_cast<ptrdiff_t>((y * canvas.width + x) * 3));
}

void frame(Image& canvas, const Box& box, const Colour& colour) {
  for (size_t x = box.x; x < box.x + box.width; ++x) {
    set_pixel(canvas, box.y, x, colour);
    set_pixel(canvas, box.y + box.height - 1, x, colour);
  }
  for (size_t y = box.y; y < box.y + box.height; ++y) {
    set_pixel(canvas, y, box.x, colour);
    set_pixel(canvas, y, box.x + box.width - 1, colour);
  }
}

}  // namespace

Image horizontal_epi(const LightFieldView& light_field, size_t view_y, size_t y) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(view_y < shape.views_y && y < shape.height, "the light field has no such row");
  Image epi(shape.width, shape.views_x, shape.channels);
  const size_t row_size = shape.width * shape.channels;
  for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
    copy_values(light_field[view_y][view_x][y],
                StridedView<float, 2>(epi.pixels.data() + view_x * row_size, {shape.width, shape.channels}));
  }
  return epi;
}

Image vertical_epi(const LightFieldView& light_field, size_t view_x, size_t x) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(view_x < shape.views_x && x < shape.width, "the light field has no such column");
  Image epi(shape.views_y, shape.height, shape.channels);
  for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
    const auto view = light_field[view_y][view_x];
    for (size_t y = 0; y < shape.height; ++y) {
      for (size_t c = 0; c < shape.channels; ++c) {
        epi.pixels[(y * shape.views_y + view_y) * shape.channels + c] = view[y][x][c];
      }
    }
  }
  return epi;
}

EpiPictureOptions middle_cut(const Shape& shape) {
  EpiPictureOptions options;
  options.view_y = shape.views_y / 2;
  options.view_x = shape.views_x / 2;
  options.y = shape.height / 2;
  options.x = shape.width / 2;
  return options;
}

Image epi_picture(const LightFieldView& light_field, const EpiPictureOptions& options) {
  const Shape shape = shape_of(light_field);
  const Image view = view_image(light_field, options.view_y, options.view_x);
  const Image below = horizontal_epi(light_field, options.view_y, options.y);
  const Image beside = vertical_epi(light_field, options.view_x, options.x);

  const Box below_box{shape.height + kGapPx, 0, shape.views_x * kEpiPxPerView, shape.width};
  const Box beside_box{0, shape.width + kGapPx, shape.height, shape.views_y * kEpiPxPerView};
  Image canvas(beside_box.x + beside_box.width, below_box.y + below_box.height, 3);
  std::fill(canvas.pixels.begin(), canvas.pixels.end(), 1.0F);
  paste(view, 0, 0, canvas);
  paste(enlarged(below, kEpiPxPerView, 1), below_box.y, below_box.x, canvas);
  paste(enlarged(beside, 1, kEpiPxPerView), beside_box.y, beside_box.x, canvas);
  for (float& value : canvas.pixels) value = std::clamp(value, 0.0F, 1.0F);

  for (size_t x = 0; x < shape.width; ++x) set_pixel(canvas, options.y, x, kRowColour);
  for (size_t y = 0; y < shape.height; ++y) set_pixel(canvas, y, options.x, kColumnColour);
  frame(canvas, below_box, kRowColour);
  frame(canvas, beside_box, kColumnColour);
  return canvas;
}

}  // namespace e2lf::lightfield
