// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "e2lf/base/threads.h"
#include "e2lf/lightfield/crop.h"

namespace e2lf::lightfield {
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
    std::fill(row.begin(), row.end(), 0.0F);
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

Image contact_sheet(const LightFieldView& light_field, const ContactSheetOptions& options) {
  const Shape shape = shape_of(light_field);
  const size_t gap = options.separator_px;
  E2LF_REQUIRE(shape.size() > 0, "a contact sheet needs views");
  E2LF_REQUIRE(options.max_width >= shape.views_x + gap * (shape.views_x - 1), "the sheet is too narrow for its views");
  const size_t width = std::min(shape.width, (options.max_width - gap * (shape.views_x - 1)) / shape.views_x);
  const size_t height = std::max<size_t>(1, (shape.height * width + shape.width / 2) / shape.width);

  Image sheet(shape.views_x * (width + gap) - gap, shape.views_y * (height + gap) - gap, shape.channels);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), options.separator_value);
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
      const Image small = shrink(view_image(light_field, view_y, view_x), width, height);
      const size_t row_size = width * shape.channels;
      for (size_t y = 0; y < height; ++y) {
        const size_t to = ((view_y * (height + gap) + y) * sheet.width + view_x * (width + gap)) * shape.channels;
        std::copy_n(small.pixels.data() + y * row_size, row_size, sheet.pixels.data() + to);
      }
    }
  });
  return sheet;
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

}  // namespace e2lf::lightfield
