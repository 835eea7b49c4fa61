// SPDX-License-Identifier: MIT
#include "e2lf/geometry/aperture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace e2lf::geometry {
namespace {

using Vector3 = std::array<double, 3>;
using Matrix3 = std::array<Vector3, 3>;

/// The second moments of a pattern about its centroid, in squared view steps: along rows, along columns, and mixed.
using Spread = std::array<double, 3>;

Spread measure(std::span<const float> pattern, size_t columns, double area, double reference_y, double reference_x,
               size_t number, AperturePicture& picture) {
  double row = 0, column = 0;
  for (size_t i = 0; i < pattern.size(); ++i) {
    row += pattern[i] * static_cast<double>(i / columns) / area;
    column += pattern[i] * static_cast<double>(i % columns) / area;
  }
  Spread spread = {};
  for (size_t i = 0; i < pattern.size(); ++i) {
    const double y = static_cast<double>(i / columns) - row, x = static_cast<double>(i % columns) - column;
    spread[0] += pattern[i] * y * y / area;
    spread[1] += pattern[i] * x * x / area;
    spread[2] += pattern[i] * y * x / area;
  }
  picture.offset_y = row - reference_y;
  picture.offset_x = column - reference_x;
  picture.area = area / static_cast<double>(pattern.size());
  picture.log_area = std::log(picture.area / kPlaceAreas[std::min(number, kSlots - 1)]);
  picture.gain = kPlaceAreas[1] / picture.area;
  picture.weight = 1 / (0.5 + spread[0] + spread[1]);
  return spread;
}

double determinant(const Matrix3& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// Solves m x = b by Cramer's rule.
Vector3 solve(const Matrix3& m, const Vector3& b) {
  const double of_all = determinant(m);
  Vector3 x = {};
  for (size_t i = 0; i < 3; ++i) {
    Matrix3 replaced = m;
    for (size_t row = 0; row < 3; ++row) replaced[row][i] = b[row];
    x[i] = determinant(replaced) / of_all;
  }
  return x;
}

/// Fits the picture and its derivatives at the reference.
void fit_moments(std::vector<AperturePicture>& pictures) {
  constexpr double kRidge = 0.02;  // of the derivatives, per picture
  const auto design = [](const AperturePicture& p) { return Vector3{1, p.offset_y, p.offset_x}; };
  Matrix3 normal = {};
  for (const AperturePicture& picture : pictures) {
    const Vector3 d = design(picture);
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) normal[i][j] += picture.weight * d[i] * d[j];
    }
  }
  for (size_t i = 1; i < 3; ++i) normal[i][i] += kRidge * static_cast<double>(pictures.size());
  for (AperturePicture& picture : pictures) {
    Vector3 weighted = design(picture);
    for (double& value : weighted) value *= picture.weight;
    picture.moments = solve(normal, weighted);
  }
}

void fill_slots(std::vector<AperturePicture>& pictures) {
  const size_t last = std::min<size_t>(kSlots, pictures.size()) - 1;
  pictures[0].slots[0] = pictures[1].slots[1] = 1;
  for (size_t p = last; p < pictures.size(); ++p) {
    pictures[p].slots[kSlots - 1] = 1 / static_cast<double>(pictures.size() - last);
  }
}

/// Distributes the pictures over the places, by their squared distances in view steps, and balances the shares until
/// both sums are right (Sinkhorn's algorithm).
void fill_places(std::vector<AperturePicture>& pictures) {
  constexpr size_t kIterations = 500;
  constexpr double kNegligible = 1e-12;  // keeps pictures that are far from all places
  const double of_each = static_cast<double>(kSlots) / static_cast<double>(pictures.size());
  for (AperturePicture& picture : pictures) {
    for (size_t place = 0; place < kSlots; ++place) {
      const double dy = picture.offset_y - kPlaces[place][0], dx = picture.offset_x - kPlaces[place][1];
      picture.places[place] = picture.weight * std::max(std::exp(-0.5 * (dy * dy + dx * dx)), kNegligible);
    }
  }
  for (size_t i = 0; i < kIterations; ++i) {
    for (AperturePicture& picture : pictures) {
      const double sum = std::accumulate(picture.places.begin(), picture.places.end(), 0.0);
      for (double& share : picture.places) share *= of_each / sum;
    }
    for (size_t place = 0; place < kSlots; ++place) {
      double sum = 0;
      for (const AperturePicture& picture : pictures) sum += picture.places[place];
      for (AperturePicture& picture : pictures) picture.places[place] /= sum;
    }
  }
}

std::array<double, kApertureConstants> constants_of(const std::vector<AperturePicture>& pictures,
                                                    const std::vector<Spread>& spreads) {
  constexpr double kScale = 0.3, kLeastNoise = 1e-4;  // patterns without parallax along an axis have a moment of 0
  const auto number = static_cast<double>(pictures.size());
  double log_weight = 0, log_weight_squared = 0;
  Vector3 noise = {};
  std::array<double, kSlots> log_area = {}, offset_y = {}, offset_x = {};
  Spread spread = {};
  for (size_t p = 0; p < pictures.size(); ++p) {
    const double log_of_weight = std::log(pictures[p].weight);
    log_weight += log_of_weight / number;
    log_weight_squared += log_of_weight * log_of_weight / number;
    for (size_t i = 0; i < 3; ++i) {
      noise[i] += pictures[p].moments[i] * pictures[p].moments[i];
      spread[i] += pictures[p].weight * spreads[p][i] / number;
    }
    for (size_t slot = 0; slot < kSlots; ++slot) {
      log_area[slot] += pictures[p].slots[slot] * pictures[p].log_area;
      offset_y[slot] += pictures[p].slots[slot] * pictures[p].offset_y;
      offset_x[slot] += pictures[p].slots[slot] * pictures[p].offset_x;
    }
  }
  const double deviation = std::sqrt(std::max(0.0, log_weight_squared - log_weight * log_weight));
  std::array<double, kApertureConstants> constants = {};
  auto next = constants.begin();
  for (const double value : log_area) *next++ = 0.5 * value;
  for (const auto& axis : {offset_y, offset_x}) {
    for (const double value : axis) *next++ = kScale * value;
  }
  for (const double value : noise) *next++ = kScale * std::log(value + kLeastNoise);
  for (const double value : spread) *next++ = kScale * value;
  *next++ = kScale * deviation;
  *next++ = std::log(number / 3);
  return constants;
}

/// Returns true if the centroids are not all the same.
bool has_parallax(const std::vector<AperturePicture>& pictures) {
  constexpr double kLeastStep = 0.1;
  return std::any_of(pictures.begin(), pictures.end(), [&](const AperturePicture& picture) {
    return std::hypot(picture.offset_y - pictures[0].offset_y, picture.offset_x - pictures[0].offset_x) > kLeastStep;
  });
}

}  // namespace

Result<Aperture> describe_aperture(const capture::Codes& codes) {
  if (!capture::is_black_first(codes)) {
    return fail(ErrorCode::kInvalidValue, "",
                "the first pattern is not black, so its picture is unknown; show a black pattern first")
        .about("codes");
  }
  Aperture aperture;
  std::vector<Spread> spreads;
  for (size_t n = 1; n < codes.num_patterns; ++n) {
    const std::span<const float> pattern = codes.pattern(n);
    const double area = std::accumulate(pattern.begin(), pattern.end(), 0.0);
    if (area <= 0) continue;
    aperture.pictures.push_back({.transition = n - 1});
    spreads.push_back(measure(pattern, codes.views_x, area, static_cast<double>(codes.views_y / 2),
                              static_cast<double>(codes.views_x / 2), aperture.pictures.size() - 1,
                              aperture.pictures.back()));
  }
  if (!has_parallax(aperture.pictures)) {
    return fail(ErrorCode::kInvalidValue, "",
                "there is no parallax, because all lit patterns have the same centroid; show at least two with "
                "different ones")
        .about("codes");
  }
  double total = 0;
  for (const AperturePicture& picture : aperture.pictures) total += picture.weight;
  for (AperturePicture& picture : aperture.pictures) {
    picture.weight *= static_cast<double>(aperture.pictures.size()) / total;
  }
  fit_moments(aperture.pictures);
  fill_slots(aperture.pictures);
  fill_places(aperture.pictures);
  aperture.constants = constants_of(aperture.pictures, spreads);
  return aperture;
}

}  // namespace e2lf::geometry
