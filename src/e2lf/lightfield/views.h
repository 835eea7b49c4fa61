// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// A rectangle of pixels, [y, y + height) x [x, x + width).
struct CropRegion {
  size_t y = 0, x = 0, height = 0, width = 0;
};

/// Cuts the same rectangle out of every view. Fails with kInvalidValue if it is empty or extends beyond the views.
[[nodiscard]] Result<LightField> crop(const LightFieldView& light_field, const CropRegion& region);

/// Returns one view as an image. A view that does not exist breaks the contract.
[[nodiscard]] Image view_image(const LightFieldView& light_field, size_t view_y, size_t view_x);

/// Returns the light field in grey; see grey_of(). It must be in colour.
[[nodiscard]] LightField to_grey(const LightFieldView& colour);

/// Reorders the views in place according to capture::Orientation. Applying it twice restores the order. With kTurned,
/// every disparity changes its sign.
void orient(const LightFieldOutput& light_field, const capture::Orientation& orientation);

/// Returns the note "views" for the run record of a reconstruction: the orientation of the capture's views, and the
/// orientation in which the files still store them.
[[nodiscard]] Json views_note(const capture::Orientation& capture, const capture::Orientation& stored);

/// Returns the orientation that still has to be applied to the stored views, according to the note "views" in the
/// run.json of the folder. It is upright if there is no note. `path` is the folder or the lightfield.npy in it. Fails
/// with kInvalidValue if the note is not an orientation.
[[nodiscard]] Result<capture::Orientation> stored_orientation(const std::filesystem::path& path);

/// Shrinks an image by a box filter: each pixel is the mean of the rectangle that it covers, with fractional edges. A
/// width or height that is 0 or larger than that of the image breaks the contract.
[[nodiscard]] Image shrink(const Image& image, size_t width, size_t height);

inline constexpr size_t kSheetGapPx = 2;

/// Returns all views in one picture, in the order of the aperture and kSheetGapPx apart on white, scaled down by a
/// common factor so that the sheet is at most max_width px wide. Views are never enlarged. The contract is broken if
/// max_width leaves less than a pixel per view or if the light field has no pixels.
[[nodiscard]] Image contact_sheet(const LightFieldView& light_field, size_t max_width = 1600);

/// Returns the image with each pixel repeated times_y x times_x times.
[[nodiscard]] Image enlarged(const Image& image, size_t times_y, size_t times_x);

/// Copies a picture to a place on a canvas that holds it; a grey picture becomes coloured on a coloured canvas.
void paste(const Image& picture, size_t top, size_t left, Image& canvas);

/// Returns pictures of one size side by side, with white gaps between them.
[[nodiscard]] Image side_by_side(const std::vector<Image>& pictures);

/// Returns the horizontal epipolar plane image (EPI) of one pixel row in one row of views as [view_x, x]. A point of
/// disparity d moves by +d px from each row of the EPI to the next. A view or pixel row that does not exist breaks the
/// contract.
[[nodiscard]] Image horizontal_epi(const LightFieldView& light_field, size_t view_y, size_t y);

/// Returns the vertical EPI of one pixel column in one column of views as [y, view_y]. A point moves down by d px from
/// each column of the EPI to the next.
[[nodiscard]] Image vertical_epi(const LightFieldView& light_field, size_t view_x, size_t x);

/// The place of the cut and the layout of the EPI picture.
struct EpiPictureOptions {
  size_t view_y = 0, view_x = 0;  ///< the view shown; the EPIs cut through its row and column of views
  size_t y = 0, x = 0;            ///< the pixel row and column that are cut
};

/// The enlargement of EPIs along the view axis.
inline constexpr size_t kEpiPxPerView = 6;

/// Returns the options for a cut through the middle: the view next to the middle of the grid (views / 2), and its
/// middle row and column.
[[nodiscard]] EpiPictureOptions middle_cut(const Shape& shape);

/// Draws a colour picture as usual in papers: the view with the cut row (blue) and column (green) marked, its
/// horizontal EPI below in a blue frame, and its vertical EPI to the right in a green one. The EPIs are enlarged by
/// kEpiPxPerView, and the parts are 4 px apart. A cut outside the light field breaks the contract.
[[nodiscard]] Image epi_picture(const LightFieldView& light_field, const EpiPictureOptions& options);

}  // namespace e2lf::lightfield
