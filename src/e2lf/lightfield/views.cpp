// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/views.h"

#include <algorithm>
#include <array>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"

namespace e2lf::lightfield {
namespace {

/// Returns whether a range is not empty and lies inside the extent.
bool fits(size_t first, size_t count, size_t extent) {
  return count > 0 && first < extent && count <= extent - first;
}

Image image_of(const StridedView<const float, 3>& pixels) {
  const auto [height, width, channels] = pixels.extents;
  Image image(width, height, channels);
  copy_values(pixels, StridedView<float, 3>(image.pixels.data(), pixels.extents));
  return image;
}

}  // namespace

Result<LightField> crop(const LightFieldView& light_field, const CropRegion& region) {
  const Shape shape = shape_of(light_field);
  if (!fits(region.y, region.height, shape.height) || !fits(region.x, region.width, shape.width)) {
    return fail(ErrorCode::kInvalidValue, "", "cannot crop ", region.height, "x", region.width, " pixels at (y ",
                region.y, ", x ", region.x, ") from views of ", shape.height, "x", shape.width,
                "; choose a region inside the views");
  }
  LightField cropped({shape.views_y, shape.views_x, region.height, region.width, shape.channels});
  const LightFieldOutput to = cropped;
  copy_values(LightFieldView(&light_field[0][0][region.y][region.x][0], to.extents, light_field.strides), to);
  return cropped;
}

Image view_image(const LightFieldView& light_field, size_t view_y, size_t view_x) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(view_y < shape.views_y && view_x < shape.views_x, "the light field has no such view");
  return image_of(light_field[view_y][view_x]);
}

LightField to_grey(const LightFieldView& colour) {
  Shape shape = shape_of(colour);
  E2LF_REQUIRE(shape.channels == 3, "a light field in colour");
  shape.channels = 1;
  LightField grey = LightField::unset(shape);
  std::vector<float> scratch;
  const float* pixel = colour.values(scratch).data();
  for (float& value : grey.data()) {
    value = grey_of(pixel[0], pixel[1], pixel[2]);
    pixel += 3;
  }
  return grey;
}

namespace fs = std::filesystem;
using capture::Orientation;

void orient(const LightFieldOutput& light_field, const Orientation& orientation) {
  const Shape shape = shape_of(light_field);
  std::vector<float> scratch(shape.view_size());
  for (size_t row = 0; row < shape.views_y; ++row) {
    for (size_t column = 0; column < shape.views_x; ++column) {
      const size_t to_row = orientation.flip_y ? shape.views_y - 1 - row : row;
      const size_t to_column = orientation.flip_x ? shape.views_x - 1 - column : column;
      if (row * shape.views_x + column >= to_row * shape.views_x + to_column) continue;
      const auto view = light_field[row][column], other = light_field[to_row][to_column];
      const StridedView<float, 3> held(scratch.data(), view.extents);
      copy_values(view, held);
      copy_values(other, view);
      copy_values(held, other);
    }
  }
}

Json views_note(const Orientation& capture, const Orientation& stored) {
  return {{"capture", capture::orientation_name(capture)}, {"stored", capture::orientation_name(stored)}};
}

Result<Orientation> stored_orientation(const fs::path& path) {
  const bool is_in_folder = is_folder(path);
  if (!is_in_folder && path.filename() != "lightfield.npy") return Orientation{};
  const fs::path record_path = (is_in_folder ? path : path.parent_path()) / "run.json";
  if (!is_our_record(record_path)) return Orientation{};
  E2LF_ASSIGN_OR_RETURN(const Json record, read_json(record_path));
  const Json::json_pointer place("/notes/views/stored");
  if (!record.contains(place)) return Orientation{};
  const std::string location = cat(record_path.string(), ": $.notes.views.stored");
  if (!record.at(place).is_string()) {
    return fail(ErrorCode::kInvalidValue, location,
                "the orientation of the views is not a text; reconstruct the light field again");
  }
  return capture::orientation_from_name(record.at(place).get<std::string>(), location);
}

namespace {

/// The weight of input pixel `index` in an output pixel.
struct Share {
  size_t index;
  float weight;
};

/// Returns the input pixels that each of `size` output pixels covers. Their weights sum to 1.
std::vector<std::vector<Share>> box_shares(size_t input_size, size_t size) {
  std::vector<std::vector<Share>> shares(size);
  const double scale = static_cast<double>(input_size) / static_cast<double>(size);
  for (size_t i = 0; i < size; ++i) {
    const double begin = static_cast<double>(i) * scale, end = static_cast<double>(i + 1) * scale;
    for (auto j = static_cast<size_t>(begin); j < input_size && static_cast<double>(j) < end; ++j) {
      const double overlap = std::min(end, static_cast<double>(j + 1)) - std::max(begin, static_cast<double>(j));
      if (overlap > 0) shares[i].push_back({j, static_cast<float>(overlap / scale)});
    }
  }
  return shares;
}

}  // namespace

Image shrink(const Image& image, size_t width, size_t height) {
  E2LF_REQUIRE(width > 0 && height > 0 && width <= image.width && height <= image.height,
               "an image can only shrink, and not to nothing");
  const auto rows = box_shares(image.height, height), columns = box_shares(image.width, width);
  const size_t channels = image.channels;
  Image small(width, height, channels);
  std::vector<float> row(image.width * channels);
  for (size_t y = 0; y < height; ++y) {
    std::ranges::fill(row, 0.0F);
    for (const Share& share : rows[y]) {
      const float* source = image.pixels.data() + share.index * row.size();
      for (size_t i = 0; i < row.size(); ++i) row[i] += share.weight * source[i];
    }
    float* out = small.pixels.data() + y * width * channels;
    for (size_t x = 0; x < width; ++x) {
      for (const Share& share : columns[x]) {
        for (size_t c = 0; c < channels; ++c) out[x * channels + c] += share.weight * row[share.index * channels + c];
      }
    }
  }
  return small;
}

Image contact_sheet(const LightFieldView& light_field, size_t max_width) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(shape.size() > 0, "a contact sheet needs views");
  E2LF_REQUIRE(max_width >= shape.views_x + kSheetGapPx * (shape.views_x - 1), "the sheet is too narrow for its views");
  const size_t width = std::min(shape.width, (max_width - kSheetGapPx * (shape.views_x - 1)) / shape.views_x);
  const size_t height = std::max<size_t>(1, (shape.height * width + shape.width / 2) / shape.width);

  Image sheet(shape.views_x * (width + kSheetGapPx) - kSheetGapPx, shape.views_y * (height + kSheetGapPx) - kSheetGapPx,
              shape.channels);
  std::ranges::fill(sheet.pixels, 1.0F);
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
      const Image small = shrink(view_image(light_field, view_y, view_x), width, height);
      paste(small, view_y * (height + kSheetGapPx), view_x * (width + kSheetGapPx), sheet);
    }
  });
  return sheet;
}

void paste(const Image& picture, size_t top, size_t left, Image& canvas) {
  for (size_t y = 0; y < picture.height; ++y) {
    for (size_t x = 0; x < picture.width; ++x) {
      const float* from = picture.pixels.data() + (y * picture.width + x) * picture.channels;
      float* to = canvas.pixels.data() + ((top + y) * canvas.width + left + x) * canvas.channels;
      for (size_t c = 0; c < canvas.channels; ++c) to[c] = from[std::min(c, picture.channels - 1)];
    }
  }
}

Image side_by_side(const std::vector<Image>& pictures) {
  constexpr size_t kGapPx = 4;
  const Image& first = pictures.front();
  Image all(pictures.size() * (first.width + kGapPx) - kGapPx, first.height, first.channels);
  std::ranges::fill(all.pixels, 1.0F);
  for (size_t i = 0; i < pictures.size(); ++i) paste(pictures[i], 0, i * (first.width + kGapPx), all);
  return all;
}

Image enlarged(const Image& image, size_t times_y, size_t times_x) {
  Image large(image.width * times_x, image.height * times_y, image.channels);
  for (size_t y = 0; y < large.height; ++y) {
    for (size_t x = 0; x < large.width; ++x) {
      std::copy_n(image.pixels.data() + (y / times_y * image.width + x / times_x) * image.channels, image.channels,
                  large.pixels.data() + (y * large.width + x) * image.channels);
    }
  }
  return large;
}

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
  const auto row = light_field[view_y][0][y];
  return image_of({row.data,
                   {shape.views_x, shape.width, shape.channels},
                   {light_field.strides[1], row.strides[0], row.strides[1]}});
}

Image vertical_epi(const LightFieldView& light_field, size_t view_x, size_t x) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(view_x < shape.views_x && x < shape.width, "the light field has no such column");
  const auto view = light_field[0][view_x];
  return image_of({&view[0][x][0],
                   {shape.height, shape.views_y, shape.channels},
                   {view.strides[0], light_field.strides[0], view.strides[2]}});
}

EpiPictureOptions middle_cut(const Shape& shape) {
  return {.view_y = shape.views_y / 2, .view_x = shape.views_x / 2, .y = shape.height / 2, .x = shape.width / 2};
}

Image epi_picture(const LightFieldView& light_field, const EpiPictureOptions& options) {
  const Shape shape = shape_of(light_field);
  const Image view = view_image(light_field, options.view_y, options.view_x);
  const Image below = horizontal_epi(light_field, options.view_y, options.y);
  const Image beside = vertical_epi(light_field, options.view_x, options.x);

  const Box below_box{shape.height + kGapPx, 0, shape.views_x * kEpiPxPerView, shape.width};
  const Box beside_box{0, shape.width + kGapPx, shape.height, shape.views_y * kEpiPxPerView};
  Image canvas(beside_box.x + beside_box.width, below_box.y + below_box.height, 3);
  std::ranges::fill(canvas.pixels, 1.0F);
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
