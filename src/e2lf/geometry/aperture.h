// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::geometry {

/// What a network for any patterns is told about the patterns as a whole: the number of elements.
inline constexpr size_t kApertureConstants = 17;

/// The slots of pictures: the first one, which follows black, the second one, and the mean of the later ones.
inline constexpr size_t kSlots = 3;

/// One picture that the events show: the scene through a pattern that is not black.
struct AperturePicture {
  size_t transition = 0;                  ///< number of the event image that ends with this pattern
  double offset_y = 0, offset_x = 0;      ///< centroid of the pattern from view (views_y / 2, views_x / 2), view steps
  double area = 0;                        ///< of the pattern, as a share of the open aperture
  double log_area = 0;                    ///< logarithm of the area over that of the pattern of e2lf-n4 in this place
  double gain = 1;                        ///< what makes the intensities behind all patterns alike
  double weight = 1;                      ///< in comparisons: sharper pictures have more; 1 in the mean
  std::array<double, kSlots> slots = {};  ///< coefficients of this picture in the slots
  /// Shares of this picture in those that are moved to the places of the patterns of e2lf-n4. Each place takes pictures
  /// with a sum of 1, most of those whose centroids are near, and all pictures give the same in total.
  std::array<double, kSlots> places = {};
  /// Coefficients of this picture in the central picture and in its derivatives with respect to the row and the column
  /// of the viewpoint.
  std::array<double, 3> moments = {};
};

/// The centroids of the lit patterns of e2lf-n4 from view (4, 4), (row, column), view steps.
inline constexpr std::array<std::array<double, 2>, kSlots> kPlaces = {{{-1.2, -2.6}, {1.875, 1.875}, {-16.0 / 7, 2}}};

/// Their areas, as shares of the open aperture: what networks learn is relative to them.
inline constexpr std::array<double, kSlots> kPlaceAreas = {5.0 / 64, 8.0 / 64, 7.0 / 64};

/// The pictures of a sequence of patterns, and constants that describe it: areas and centroids of the slots, the noise
/// that the fit amplifies, second moments of the patterns, their range, and the number of pictures.
struct Aperture {
  std::vector<AperturePicture> pictures;
  std::array<double, kApertureConstants> constants = {};
};

/// Describes patterns, of which the first must be black. The central picture and its derivatives follow from the
/// pictures by a linear least-squares fit over the centroids, in which blurred pictures have less weight and the
/// derivatives a small ridge. Fails with kInvalidValue if the first pattern is not black, or if fewer than two others
/// have different centroids.
[[nodiscard]] Result<Aperture> describe_aperture(const capture::Codes& codes);

}  // namespace e2lf::geometry
