// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <numeric>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// Returns a small light field whose samples are multiples of 1 / 255 and differ along every axis.
inline LightField numbered_light_field(const Shape& shape) {
  LightField out(shape);
  for (size_t i = 0; i < out.data().size(); ++i) {
    const size_t view = i / shape.view_size(), inside = i % shape.view_size();
    out.data()[i] = static_cast<float>((view * 37 + inside * 11 + inside / 7) % 256) / 255.0F;
  }
  return out;
}

/// Returns a light field in which every value is its own index.
inline LightField indexed_light_field(const Shape& shape) {
  LightField out(shape);
  std::iota(out.data().begin(), out.data().end(), 0.0F);
  return out;
}

/// Returns the lenslet mosaic of a light field: sample (y * views_y + view_y, x * views_x + view_x).
inline Image mosaic_of(const LightField& field) {
  const Shape& shape = field.shape();
  Image mosaic(shape.width * shape.views_x, shape.height * shape.views_y, shape.channels);
  for (size_t i = 0; i < mosaic.pixels.size(); ++i) {
    const size_t c = i % shape.channels, x = i / shape.channels % mosaic.width, y = i / shape.channels / mosaic.width;
    mosaic.pixels[i] = field.at(y % shape.views_y, x % shape.views_x, y / shape.views_y, x / shape.views_x, c);
  }
  return mosaic;
}

inline bool same(const LightField& a, const LightField& b) {
  return a.shape() == b.shape() && std::equal(a.data().begin(), a.data().end(), b.data().begin());
}

}  // namespace e2lf::lightfield
