// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "e2lf/calibrate/still_scene.h"

namespace e2lf::calibrate {

/// Pixels around which a scene is flat, and how bright it is there.
struct FlatAreas {
  std::vector<bool> is_flat;
  Plane brightness;  ///< mean count of the first two transitions together, over a Gaussian of 7 px
};

/// Finds flat areas. Neighbouring pixels have independent noise. So a fine texture shows in the variance of counts that
/// were blurred by 1.5 px: beside the variance of the counts themselves it is larger than that of white noise. A slope
/// shows in the gradient of counts that were blurred by 6 px. The first transition may have a slope, since brightness
/// is told apart anyway; in the later ones a change of the picture means that patterns see different things (parallax).
/// Pixels nearer than 40 px to the edges (or an eighth of the picture) and bad pixels are never flat.
[[nodiscard]] FlatAreas find_flat_areas(const StillScene& scene, const std::vector<PixelState>& states);

/// For a picture that is known to be even within each cell of the field: all good pixels but those at the edges, and
/// for each the mean brightness of its cell. Nothing is chosen by what it counted. In find_flat_areas() neighbours with
/// the same noise are chosen together, which moves constants by a few percent.
[[nodiscard]] FlatAreas even_areas(const StillScene& scene, const std::vector<PixelState>& states);

/// Flat pixels of about one brightness in one part of the picture, and how often each combination of counts occurs.
struct Area {
  size_t row = 0;   ///< of brightness
  size_t cell = 0;  ///< of the field, kFieldColumns * field row + column
  size_t scene = 0;
  double x = 0.0, y = 0.0;       ///< the mean place, as in capture::transmission_at()
  double samples = 0.0;          ///< pixels times cycles
  std::vector<float> histogram;  ///< shares, of histogram_size()
};

inline constexpr size_t kFieldColumns = 5, kFieldRows = 3;
inline constexpr size_t kSquarePx = 64;
inline constexpr float kRowWidth = 0.2F;

/// The row of a brightness, and the brightness in the middle of a row.
[[nodiscard]] size_t row_of(float brightness);
[[nodiscard]] float brightness_of(size_t row);

/// Whether the pixels of a square of kSquarePx are counted; a way to keep parts of the picture out.
using SquareFilter = std::function<bool(size_t square_y, size_t square_x)>;

/// The areas of a scene with at least 150 samples.
[[nodiscard]] std::vector<Area> collect_areas(const StillScene& scene, size_t scene_number, const FlatAreas& flat,
                                              const SquareFilter& is_counted);

/// The area of a pixel as collect_areas() sorts them: row * kFieldColumns * kFieldRows + cell.
[[nodiscard]] size_t area_key(const FlatAreas& flat, size_t pixel);

}  // namespace e2lf::calibrate
