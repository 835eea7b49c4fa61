// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "e2lf/lightfield/formats/readers.h"

/// The grid of views in one picture that contains all of them, as far as its content shows it: neighbouring views
/// resemble each other.
namespace e2lf::lightfield {

/// One channel of a picture, [y, x], with values in any unit.
struct Picture {
  size_t height = 0, width = 0;
  std::vector<float> values;

  [[nodiscard]] const float* row(size_t y) const { return values.data() + y * width; }
};

[[nodiscard]] Picture first_channel(const RawImage& image);

/// Returns the number of views per axis behind each lens of a lenslet mosaic: the largest n from 2 to 32 that divides
/// both sides and for which the steps from lens to lens exceed all other steps. Returns nothing if there is none, e.g.
/// in a picture without contrast or with dark borders of lenses.
[[nodiscard]] std::optional<size_t> lenslet_grid(const Picture& picture);

/// Returns the number of views per axis of a picture in which whole views stand side by side: the n from 2 to 32 that
/// divides both sides and for which the picture resembles itself one view further and not one and a half. Returns
/// nothing if this does not distinguish one n from the others.
[[nodiscard]] std::optional<size_t> montage_grid(const Picture& picture);

/// Returns whether views of this number per axis stand side by side in a picture, whose sides it divides.
[[nodiscard]] bool is_montage(const Picture& picture, size_t views);

/// Returns the numbers of views per axis, from 2 to 32, that divide both sides into views of at least 4 px.
[[nodiscard]] std::vector<size_t> possible_grids(size_t height, size_t width);

}  // namespace e2lf::lightfield
