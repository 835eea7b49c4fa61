// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::calibrate {

/// An image [y, x] with one float per pixel.
using Plane = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the plane blurred by a Gaussian of `sigma_px`, truncated at four sigma. The plane is mirrored at its edges.
[[nodiscard]] Plane blurred(const Plane& plane, double sigma_px);

/// Returns the squared length of the gradient by central differences; it is 0 at the edges.
[[nodiscard]] Plane squared_gradient(const Plane& plane);

/// The cycles of one static scene.
struct StillScene {
  std::vector<capture::EventImages> cycles;
};

enum class PixelState : uint8_t {
  kGood = 0,
  kHot = 1,   ///< of capture::hot_pixels()
  kDead = 2,  ///< it has no events although all its neighbours have some
};

/// Classifies each pixel over all scenes. A pixel is hot if it is in each of them. A dead pixel has no events although
/// its neighbours have two per cycle; it is not found if all scenes are too dark for that.
[[nodiscard]] std::vector<PixelState> find_bad_pixels(const std::vector<StillScene>& scenes);

/// Checks that there is a scene, that each has a cycle, and that all have the same shape, with at least one transition
/// and 64x64 px. Fails with kShape.
[[nodiscard]] Result<void> check_scenes(const std::vector<StillScene>& scenes);

/// Returns the mean counts of each transition, one plane each. Bad pixels get the median of their good neighbours.
[[nodiscard]] std::vector<Plane> mean_counts(const StillScene& scene, const std::vector<PixelState>& states);

/// The pixels around which a scene is flat, and their brightness.
struct FlatAreas {
  std::vector<bool> is_flat;
  Plane brightness;  ///< mean count of the first two transitions together, smoothed by a Gaussian of 7 px
};

/// Finds flat areas. The noise of neighbouring pixels is independent. A fine texture therefore shows in the variance of
/// counts blurred by 1.5 px: relative to the variance of the counts themselves, it exceeds that of white noise. A slope
/// shows in the gradient of counts blurred by 6 px. The first transition may have a slope, since brightness levels are
/// separated anyway; in later ones, a spatial change means that the patterns see different things (parallax). Bad
/// pixels and pixels closer to the edges than 40 px (or an eighth of the picture) are never flat. Only the first three
/// transitions are examined.
[[nodiscard]] FlatAreas find_flat_areas(const StillScene& scene, const std::vector<PixelState>& states);

/// Returns all good pixels except those at the edges, each with the mean brightness of its cell, for a picture that is
/// known to be even within each cell of the field. No pixel is selected by its counts. In contrast, find_flat_areas()
/// groups neighbours with similar noise, which shifts constants by a few percent.
[[nodiscard]] FlatAreas even_areas(const StillScene& scene, const std::vector<PixelState>& states);

/// Flat pixels of similar brightness in one part of the picture, and the frequencies of each combination of their
/// counts.
struct Area {
  size_t row = 0;   ///< index of the level of brightness
  size_t cell = 0;  ///< index of the cell of the field: kFieldColumns * field row + column
  size_t scene = 0;
  double x = 0.0, y = 0.0;  ///< mean position, as in capture::transmission_at()
  double samples = 0.0;     ///< pixels times cycles
  size_t transitions = 0;
  std::vector<float> histogram;  ///< relative frequencies of the counts of each group, of histogram_size()
};

inline constexpr size_t kFieldColumns = 5, kFieldRows = 3;
inline constexpr size_t kSquarePx = 64;
/// The brightness at which the rows begin, and the range of brightness of a row.
inline constexpr float kFirstRow = -1.0F, kRowWidth = 0.2F;

/// Returns true if the pixels of a square of kSquarePx are counted. It is used to keep parts of the picture out.
using SquareFilter = std::function<bool(size_t square_y, size_t square_x)>;

/// Returns the areas of a scene with at least 150 samples.
[[nodiscard]] std::vector<Area> collect_areas(const StillScene& scene, size_t scene_number, const FlatAreas& flat,
                                              const SquareFilter& is_counted);

}  // namespace e2lf::calibrate
