// SPDX-License-Identifier: MIT
// Reads lenslet mosaics; declared in readers.h.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

constexpr size_t kLytroViews = 14;

/// The number of views behind a microlens.
struct Grid {
  size_t views_y = 0, views_x = 0;
};

Result<Grid> grid_of(const std::filesystem::path& path, const ReadOptions& options) {
  if (options.lenslet_views > 0) return Grid{options.lenslet_views, options.lenslet_views};
  if (path.stem().string().ends_with("eslf")) return Grid{kLytroViews, kLytroViews};
  return Error{ErrorCode::kInvalidValue,
               "a single image is read as a lenslet mosaic; give its number of views per axis, e.g. 14 for a Lytro "
               "camera, or cut "
               "views that stand side by side into a folder",
               path.string(), Setting::kLensletViews};
}

/// The first channel of a mosaic.
struct Samples {
  const RawImage& mosaic;

  [[nodiscard]] double at(size_t y, size_t x) const {
    const size_t index = (y * mosaic.width + x) * mosaic.channels * mosaic.sample_bytes;
    return mosaic.sample_bytes == 1 ? mosaic.samples[index] : load_le<uint16_t>(&mosaic.samples[index]);
  }
  /// Returns the mean absolute difference of pixels that are this far apart.
  [[nodiscard]] double difference(size_t step_y, size_t step_x) const {
    constexpr size_t kRowStep = 4;  // a part of the rows is enough
    double sum = 0;
    size_t count = 0;
    for (size_t y = 0; y + step_y < mosaic.height; y += kRowStep) {
      for (size_t x = 0; x + step_x < mosaic.width; ++x, ++count)
        sum += std::fabs(at(y, x) - at(y + step_y, x + step_x));
    }
    return count == 0 ? 0 : sum / static_cast<double>(count);
  }
};

/// The sums of the absolute steps from each column to the next one, and from each row to the next one.
struct Steps {
  std::vector<double> x, y;
};

Steps steps_of(const RawImage& mosaic) {
  const Samples samples{mosaic};
  Steps steps{std::vector<double>(mosaic.width - 1), std::vector<double>(mosaic.height - 1)};
  for (size_t y = 0; y + 1 < mosaic.height; ++y) {
    for (size_t x = 0; x + 1 < mosaic.width; ++x) {
      steps.x[x] += std::fabs(samples.at(y, x) - samples.at(y, x + 1));
      steps.y[y] += std::fabs(samples.at(y, x) - samples.at(y + 1, x));
    }
  }
  return steps;
}

/// Returns how much larger the steps between lenses of n pixels are than those between the views behind a lens.
double contrast_of(const std::vector<double>& steps, size_t n) {
  constexpr double kNone = 1e-6;
  double between = 0, within = 0;
  for (size_t i = 0; i < steps.size(); ++i) ((i + 1) % n == 0 ? between : within) += steps[i];
  const auto lenses = static_cast<double>(steps.size() / n);
  return (between / std::max(lenses, 1.0) + kNone) /
         (within / std::max(static_cast<double>(steps.size()) - lenses, 1.0) + kNone);
}

double contrast_of(const Steps& steps, Grid grid) {
  return std::min(contrast_of(steps.x, grid.views_x), contrast_of(steps.y, grid.views_y));
}

/// Returns whether an image resembles itself one tile further, as views side by side do.
bool is_montage(const RawImage& image, Grid grid) {
  constexpr double kAlike = 0.5;
  const Samples samples{image};
  const size_t height = image.height / grid.views_y, width = image.width / grid.views_x;
  const auto are_alike = [&](size_t y, size_t x) {
    return samples.difference(y, x) < kAlike * samples.difference(y + y / 2, x + x / 2);
  };
  return are_alike(height, 0) && are_alike(0, width);
}

/// Refuses a number of views that the user or the file name states if the image has another layout: neighbouring views
/// resemble each other, so that the largest steps are those from lens to lens.
Result<void> check_layout(const RawImage& mosaic, Grid grid, const std::string& location) {
  constexpr double kClear = 2, kBetter = 1.5;
  constexpr size_t kMostViews = 32;
  if (mosaic.width < 2 || mosaic.height < 2) return {};
  const Steps steps = steps_of(mosaic);
  const double contrast = contrast_of(steps, grid);
  if (contrast < kClear && is_montage(mosaic, grid)) {
    return fail(ErrorCode::kUnsupported, location,
                "the image contains whole views side by side instead of a lenslet mosaic; cut it into a folder of "
                "VV_UU.png (row_column)");
  }
  const size_t common = std::gcd(mosaic.width, mosaic.height);
  for (size_t n = 2; n <= kMostViews; ++n) {
    if (common % n != 0 || (n == grid.views_x && n == grid.views_y)) continue;
    const double other = contrast_of(steps, Grid{n, n});
    if (other < kClear || other < kBetter * contrast) continue;
    return Error{ErrorCode::kInvalidValue,
                 cat("neighbouring pixels of the mosaic resemble each other behind lenses of ", n, "x", n,
                     " views and not of ", grid.views_y, "x", grid.views_x, "; give the number of views per axis"),
                 location, Setting::kLensletViews};
  }
  return {};
}

}  // namespace

Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string();
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const RawImage mosaic,
                        is_png(bytes) ? decode_png(bytes, location) : decode_jpeg(bytes, location));
  E2LF_ASSIGN_OR_RETURN(const Grid grid, grid_of(path, options));
  if (mosaic.width % grid.views_x != 0 || mosaic.height % grid.views_y != 0) {
    return fail(ErrorCode::kShape, location, "a mosaic of ", mosaic.width, "x", mosaic.height,
                " samples does not divide into microlenses of ", grid.views_y, "x", grid.views_x,
                " views; a single image is read as such a mosaic, give the folder to read views in separate files");
  }
  E2LF_RETURN_IF_ERROR(check_layout(mosaic, grid, location));
  StoredArray array = stored_view(mosaic);
  array.shape = {grid.views_y, grid.views_x, mosaic.height / grid.views_y, mosaic.width / grid.views_x,
                 mosaic.channels};
  array.strides = huwvc_strides(array.shape);
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
