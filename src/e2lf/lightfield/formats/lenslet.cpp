// SPDX-License-Identifier: MIT
// Reads lenslet mosaics, and finds the grid of views in one picture that contains all of them, as far as its content
// shows it: neighbouring views resemble each other. Declared in readers.h.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

constexpr size_t kMostViews = 32;
/// Keeps quotients of differences finite in pictures without contrast.
constexpr double kNone = 1e-4;

/// Returns the mean absolute difference of values that are this far apart.
double difference(const Picture& picture, size_t step_y, size_t step_x) {
  constexpr size_t kRowStep = 4;  // a part of the rows is enough
  double sum = 0;
  size_t count = 0;
  for (size_t y = 0; y + step_y < picture.height; y += kRowStep) {
    const float *const here = picture.row(y), *const there = picture.row(y + step_y) + step_x;
    for (size_t x = 0; x + step_x < picture.width; ++x, ++count) sum += std::fabs(here[x] - there[x]);
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

/// Returns the difference to the neighbouring views relative to that one and a half views further, for the axis in
/// which it is larger. It is far below 1 if `views` views per axis stand side by side.
double montage_ratio(const Picture& picture, size_t views, double contrast) {
  const size_t height = picture.height / views, width = picture.width / views;
  const double floor = kNone * contrast + 1e-30;
  const auto ratio = [&](size_t y, size_t x) {
    return (difference(picture, y, x) + floor) / (difference(picture, y + y / 2, x + x / 2) + floor);
  };
  return std::max(ratio(height, 0), ratio(0, width));
}

double contrast_of(const Picture& picture) {
  const auto [low, high] = std::minmax_element(picture.values.begin(), picture.values.end());
  return picture.values.empty() ? 0 : double{*high} - double{*low};
}

/// The sums of the absolute steps from each column to the next one, and from each row to the next one.
struct Steps {
  std::vector<double> x, y;
};

Steps steps_of(const Picture& picture) {
  Steps steps{std::vector<double>(picture.width - 1), std::vector<double>(picture.height - 1)};
  for (size_t y = 0; y + 1 < picture.height; ++y) {
    const float *const row = picture.row(y), *const below = picture.row(y + 1);
    for (size_t x = 0; x + 1 < picture.width; ++x) {
      steps.x[x] += std::fabs(row[x] - row[x + 1]);
      steps.y[y] += std::fabs(row[x] - below[x]);
    }
  }
  return steps;
}

/// Returns how much larger the steps between lenses of n pixels are than those between any two neighbouring views
/// behind a lens.
double lens_contrast(const std::vector<double>& steps, size_t n) {
  std::vector<double> sums(n), counts(n);
  double total = 0;
  for (size_t i = 0; i < steps.size(); ++i) {
    sums[(i + 1) % n] += steps[i];
    counts[(i + 1) % n] += 1;
    total += steps[i];
  }
  if (total <= 0) return 0;
  const double floor = kNone * total / static_cast<double>(steps.size());
  const auto mean = [&](size_t i) { return sums[i] / std::max(counts[i], 1.0) + floor; };
  double most_within = 0;
  for (size_t i = 1; i < n; ++i) most_within = std::max(most_within, mean(i));
  return mean(0) / most_within;
}

Picture first_channel(const RawImage& image) {
  Picture picture{image.height, image.width, std::vector<float>(image.height * image.width)};
  for (size_t i = 0; i < picture.values.size(); ++i) {
    const uint8_t* const sample = &image.samples[i * image.channels * image.sample_bytes];
    picture.values[i] = image.sample_bytes == 1 ? *sample : load_le<uint16_t>(sample);
  }
  return picture;
}

/// Returns the number of views per axis behind each lens of a lenslet mosaic: the largest n from 2 to 32 that divides
/// both sides and for which the steps from lens to lens exceed all other steps. Returns nothing if there is none, e.g.
/// in a picture without contrast or with dark borders of lenses.
std::optional<size_t> lenslet_grid(const Picture& picture) {
  constexpr double kClear = 1.3;
  if (picture.width < 2 || picture.height < 2) return std::nullopt;
  const Steps steps = steps_of(picture);
  std::optional<size_t> largest;
  for (const size_t n : possible_grids(picture.height, picture.width)) {
    if (std::min(lens_contrast(steps.x, n), lens_contrast(steps.y, n)) >= kClear) largest = n;
  }
  return largest;
}

/// Returns whether views of this number per axis stand side by side in a picture, whose sides it divides.
bool is_montage(const Picture& picture, size_t views) {
  constexpr double kAlike = 0.5;
  return montage_ratio(picture, views, contrast_of(picture)) < kAlike;
}

constexpr size_t kLytroViews = 14;

/// Returns the number of views per axis behind a lens that the user or the file name states.
Result<size_t> stated_views(const std::filesystem::path& path, const ReadOptions& options) {
  if (options.lenslet_views > 0) return options.lenslet_views;
  if (path.stem().string().ends_with("eslf")) return kLytroViews;
  return Error{ErrorCode::kInvalidValue,
               "a single image is read as a lenslet mosaic; give its number of views per axis, e.g. 14 for a Lytro "
               "camera, or cut "
               "views that stand side by side into a folder",
               path.string(), "lenslet_views"};
}

/// Refuses a number of views that the user or the file name states if the content shows another layout.
Result<void> check_layout(const RawImage& mosaic, size_t views, const std::string& location) {
  const Picture picture = first_channel(mosaic);
  const std::optional<size_t> found = lenslet_grid(picture);
  if (!found && is_montage(picture, views)) {
    return fail(ErrorCode::kUnsupported, location,
                "the image contains whole views side by side instead of a lenslet mosaic; cut it into a folder of "
                "VV_UU.png (row_column)");
  }
  if (!found || *found == views) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("neighbouring pixels of the mosaic resemble each other behind lenses of ", *found, "x", *found,
                   " views and not of ", views, "x", views, "; give the number of views per axis"),
               location, "lenslet_views"};
}

}  // namespace

std::vector<size_t> possible_grids(size_t height, size_t width) {
  constexpr size_t kLeastSide = 4;
  std::vector<size_t> grids;
  for (size_t n = 2; n <= kMostViews; ++n) {
    const bool divides = height % n == 0 && width % n == 0;
    if (divides && std::min(height, width) / n >= kLeastSide) grids.push_back(n);
  }
  return grids;
}

std::optional<size_t> montage_grid(const Picture& picture) {
  constexpr double kAlike = 0.8, kBetter = 1.1;
  const double contrast = contrast_of(picture);
  size_t best = 0;
  double lowest = 1, second = 1;
  for (const size_t n : possible_grids(picture.height, picture.width)) {
    const double ratio = montage_ratio(picture, n, contrast);
    second = std::min(second, std::max(ratio, lowest));
    if (ratio >= lowest) continue;
    lowest = ratio;
    best = n;
  }
  return lowest <= kAlike && second >= kBetter * lowest ? std::optional(best) : std::nullopt;
}

Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string();
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const RawImage mosaic, decode_raw_image(bytes, location));
  E2LF_ASSIGN_OR_RETURN(const size_t views, stated_views(path, options));
  if (mosaic.width % views != 0 || mosaic.height % views != 0) {
    return fail(ErrorCode::kShape, location, "a mosaic of ", mosaic.width, "x", mosaic.height,
                " samples does not divide into microlenses of ", views, "x", views,
                " views; a single image is read as such a mosaic, give the folder to read views in separate files");
  }
  E2LF_RETURN_IF_ERROR(check_layout(mosaic, views, location));
  StoredArray array = stored_view(mosaic);
  array.shape = {views, views, mosaic.height / views, mosaic.width / views, mosaic.channels};
  array.strides = huwvc_strides(array.shape);
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
