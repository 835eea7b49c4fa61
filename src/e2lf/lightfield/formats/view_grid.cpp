// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/formats/view_grid.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/little_endian.h"

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

}  // namespace

Picture first_channel(const RawImage& image) {
  Picture picture{image.height, image.width, std::vector<float>(image.height * image.width)};
  for (size_t i = 0; i < picture.values.size(); ++i) {
    const uint8_t* const sample = &image.samples[i * image.channels * image.sample_bytes];
    picture.values[i] = image.sample_bytes == 1 ? *sample : load_le<uint16_t>(sample);
  }
  return picture;
}

std::vector<size_t> possible_grids(size_t height, size_t width) {
  constexpr size_t kLeastSide = 4;
  std::vector<size_t> grids;
  for (size_t n = 2; n <= kMostViews; ++n) {
    const bool divides = height % n == 0 && width % n == 0;
    if (divides && std::min(height, width) / n >= kLeastSide) grids.push_back(n);
  }
  return grids;
}

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

bool is_montage(const Picture& picture, size_t views) {
  constexpr double kAlike = 0.5;
  return montage_ratio(picture, views, contrast_of(picture)) < kAlike;
}

}  // namespace e2lf::lightfield
