// SPDX-License-Identifier: MIT
#include "e2lf/recon/inversion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/input.h"

namespace e2lf::recon {
namespace {

constexpr size_t kMinChunk = 4096;

int sign(int value) {
  return (value > 0) - (value < 0);
}

}  // namespace

Result<capture::CodedIntensities> invert_events(const capture::EventImages& images, const InversionOptions& options) {
  E2LF_RETURN_IF_ERROR(IntensityTable::check(options.constants));
  if (options.black > images.count) {
    return fail(ErrorCode::kInvalidValue, "", "the black pattern is number ", options.black, " but there are ",
                images.count + 1, " patterns; count from 0");
  }
  const IntensityTable table(options.constants);
  const size_t num_patterns = images.count + 1;
  capture::CodedIntensities intensities(num_patterns, images.height, images.width);
  parallel_for(images.image_size(), kMinChunk, [&](size_t begin, size_t end) {
    std::vector<int> levels(num_patterns);  // in half thresholds, relative to the first pattern
    for (size_t pixel = begin; pixel < end; ++pixel) {
      int total = 0, last_change = 0;
      for (size_t k = 0; k < images.count; ++k) {
        const int count = images.image(k)[pixel];
        total += count;
        if (count != 0) last_change = sign(count);
        levels[k + 1] = 2 * total + (options.centred ? last_change : 0);
      }
      for (size_t n = 0; n < num_patterns; ++n) {
        intensities.image(n)[pixel] = table.at_half_steps(levels[n] - levels[options.black]);
      }
    }
  });
  return intensities;
}

namespace {

/// Computes sliding sums over the rows of columns that are next to each other, all of which advance together. The rows
/// are `stride` apart, and the first and the last one are repeated.
void column_sums(const float* in, float* out, size_t rows, size_t columns, size_t stride, size_t radius) {
  const auto last = static_cast<ptrdiff_t>(rows) - 1, reach = static_cast<ptrdiff_t>(radius);
  const auto row = [&](ptrdiff_t y) { return in + static_cast<size_t>(std::clamp<ptrdiff_t>(y, 0, last)) * stride; };
  std::vector<double> sums(columns);
  for (ptrdiff_t y = -reach; y <= reach; ++y) {
    const float* const added = row(y);
    for (size_t x = 0; x < columns; ++x) sums[x] += double{added[x]};
  }
  for (ptrdiff_t y = 0; y <= last; ++y) {
    float* const result = out + static_cast<size_t>(y) * stride;
    const float *const added = row(y + reach + 1), *const removed = row(y - reach);
    for (size_t x = 0; x < columns; ++x) {
      result[x] = static_cast<float>(sums[x]);
      sums[x] += double{added[x]} - double{removed[x]};
    }
  }
}

void denoise_image(std::span<float> image, std::span<const int16_t> counts, const capture::EventImages& images,
                   const capture::SensorConstants& constants, size_t radius) {
  const auto& [eps, tau, sigma_w, sigma_z, sigma_i] = constants;
  const float fixed = sigma_w * sigma_w + tau * tau / 12;
  std::vector<float> value(image.size()), square(image.size()), noise(image.size());
  for (size_t i = 0; i < image.size(); ++i) {
    value[i] = std::log(std::max(image[i], 0.0F) + eps);
    square[i] = value[i] * value[i];
    const float events = sigma_z * static_cast<float>(counts[i]);
    noise[i] = fixed + events * events;
  }
  const auto values = box_sums(value, images.height, images.width, radius);
  const auto squares = box_sums(square, images.height, images.width, radius);
  const auto noises = box_sums(noise, images.height, images.width, radius);
  const auto area = static_cast<float>((2 * radius + 1) * (2 * radius + 1));
  for (size_t i = 0; i < image.size(); ++i) {
    const float mean = values[i] / area, variance = squares[i] / area - mean * mean;
    const float keep = variance > 0 ? std::max(0.0F, 1 - noises[i] / area / variance) : 0.0F;
    image[i] = std::max(0.0F, std::exp(mean + keep * (value[i] - mean)) - eps);
  }
}

}  // namespace

std::vector<float> box_sums(std::span<const float> values, size_t height, size_t width, size_t radius) {
  std::vector<float> rows(values.size()), sums(values.size());
  parallel_for(height, 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) column_sums(&values[y * width], &rows[y * width], width, 1, 1, radius);
  });
  parallel_for(width, 16, [&](size_t begin, size_t end) {
    column_sums(&rows[begin], &sums[begin], height, end - begin, width, radius);
  });
  return sums;
}

void denoise_intensities(capture::CodedIntensities& intensities, const capture::EventImages& images,
                         const capture::SensorConstants& constants, size_t radius) {
  E2LF_REQUIRE(intensities.count == images.count + 1 && intensities.image_size() == images.image_size(),
               "coded intensities and event images must belong together");
  for (size_t k = 0; k < images.count; ++k) {
    denoise_image(intensities.image(k + 1), images.image(k), images, constants, radius);
  }
}

namespace {

/// Returns the squared relative spread of the pictures at one pixel for a scene at `disparity`.
float mismatch(std::span<const PlacedImage> images, size_t height, size_t width, float disparity, size_t y, size_t x) {
  constexpr float kDark = 1e-2F;  // prevents the noise of dark pixels from dominating
  float sum = 0, squares = 0;
  for (const PlacedImage& image : images) {
    const float value = sample_bilinear(image.pixels, height, width,
                                        static_cast<float>(y) + disparity * static_cast<float>(image.view_y),
                                        static_cast<float>(x) + disparity * static_cast<float>(image.view_x));
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<float>(images.size());
  const float mean = sum / count;
  return std::max(0.0F, squares / count - mean * mean) / ((mean + kDark) * (mean + kDark));
}

}  // namespace

float sample_bilinear(std::span<const float> pixels, size_t height, size_t width, float y, float x) {
  y = std::clamp(y, 0.0F, static_cast<float>(height - 1));
  x = std::clamp(x, 0.0F, static_cast<float>(width - 1));
  const auto y0 = static_cast<size_t>(y), x0 = static_cast<size_t>(x);
  const size_t y1 = std::min(y0 + 1, height - 1), x1 = std::min(x0 + 1, width - 1);
  const float fy = y - static_cast<float>(y0), fx = x - static_cast<float>(x0);
  const float top = pixels[y0 * width + x0] * (1 - fx) + pixels[y0 * width + x1] * fx;
  const float bottom = pixels[y1 * width + x0] * (1 - fx) + pixels[y1 * width + x1] * fx;
  return top * (1 - fy) + bottom * fy;
}

std::vector<float> coded_disparity(std::span<const PlacedImage> images, size_t height, size_t width) {
  constexpr int kCandidates = 12;  // on either side of 0
  constexpr float kStepPx = 0.25F;
  constexpr size_t kWindowRadius = 6;
  std::vector<float> best(height * width), best_cost(height * width, std::numeric_limits<float>::infinity());
  const bool one_place = std::all_of(images.begin(), images.end(), [&](const PlacedImage& image) {
    return image.view_y == images[0].view_y && image.view_x == images[0].view_x;
  });
  if (one_place) return best;

  std::vector<float> differences(height * width);
  for (int i = -kCandidates; i <= kCandidates; ++i) {
    const float disparity = static_cast<float>(i) * kStepPx;
    parallel_for(height, 4, [&](size_t begin, size_t end) {
      for (size_t p = begin * width; p < end * width; ++p) {
        differences[p] = mismatch(images, height, width, disparity, p / width, p % width);
      }
    });
    const std::vector<float> cost = box_sums(differences, height, width, kWindowRadius);
    for (size_t p = 0; p < best.size(); ++p) {
      if (cost[p] < best_cost[p]) {
        best_cost[p] = cost[p];
        best[p] = disparity;
      }
    }
  }
  return best;
}

namespace {

/// Returns the middle of `views` views along an axis.
double view_centre(size_t views) {
  return (static_cast<double>(views) - 1) / 2;
}

/// Places one coded image. The image of a black pattern has no pixels.
PlacedImage place_image(const capture::CodedIntensities& intensities, const capture::Codes& codes, size_t n) {
  PlacedImage image;
  double open = 0;
  const auto pattern = codes.pattern(n);
  for (size_t view = 0; view < pattern.size(); ++view) {
    open += pattern[view];
    image.view_y += pattern[view] * (static_cast<double>(view / codes.views_x) - view_centre(codes.views_y));
    image.view_x += pattern[view] * (static_cast<double>(view % codes.views_x) - view_centre(codes.views_x));
  }
  if (open == 0) return image;
  image.view_y /= open;
  image.view_x /= open;
  const auto scale = static_cast<float>(static_cast<double>(pattern.size()) / open);
  image.pixels.reserve(intensities.image_size());
  for (const float value : intensities.image(n)) image.pixels.push_back(scale * value);
  return image;
}

}  // namespace

PlacedImages place_images(const capture::CodedIntensities& intensities, const capture::Codes& codes) {
  PlacedImages placed;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    PlacedImage image = place_image(intensities, codes, n);
    if (image.pixels.empty()) continue;
    placed.images.push_back(std::move(image));
    placed.patterns.push_back(n);
  }
  return placed;
}

namespace {

using Matrix = std::vector<std::vector<double>>;

/// Solves matrix * x = right for all columns of `right` in place, by Gauss-Jordan elimination with pivoting.
void solve(Matrix matrix, Matrix& right) {
  const size_t size = matrix.size();
  for (size_t column = 0; column < size; ++column) {
    size_t pivot = column;
    for (size_t row = column; row < size; ++row) {
      if (std::abs(matrix[row][column]) > std::abs(matrix[pivot][column])) pivot = row;
    }
    std::swap(matrix[column], matrix[pivot]);
    std::swap(right[column], right[pivot]);
    for (size_t row = 0; row < size; ++row) {
      if (row == column) continue;
      const double factor = matrix[row][column] / matrix[column][column];
      for (size_t i = column; i < size; ++i) matrix[row][i] -= factor * matrix[column][i];
      for (size_t i = 0; i < right[row].size(); ++i) right[row][i] -= factor * right[column][i];
    }
  }
  for (size_t row = 0; row < size; ++row) {
    for (double& value : right[row]) value /= matrix[row][row];
  }
}

/// Returns the sum of the transmittances of a pattern.
double open_cells(std::span<const float> pattern) {
  return std::accumulate(pattern.begin(), pattern.end(), 0.0);
}

/// Computes B K, the prior correlation of each view with each normalised coded image, [pattern][view].
Matrix correlations(const capture::Codes& codes, const std::vector<size_t>& lit, double length) {
  Matrix result(lit.size(), std::vector<double>(codes.pattern_size()));
  for (size_t i = 0; i < lit.size(); ++i) {
    const auto pattern = codes.pattern(lit[i]);
    const double open = open_cells(pattern);
    for (size_t view = 0; view < codes.pattern_size(); ++view) {
      for (size_t other = 0; other < codes.pattern_size(); ++other) {
        const auto dy = static_cast<double>(view / codes.views_x) - static_cast<double>(other / codes.views_x);
        const auto dx = static_cast<double>(view % codes.views_x) - static_cast<double>(other % codes.views_x);
        result[i][view] += pattern[other] / open * std::exp(-(dy * dy + dx * dx) / (2 * length * length));
      }
    }
  }
  return result;
}

struct View {
  double y = 0, x = 0;  ///< relative to the centre of the views
  std::vector<float> weights;
};

/// Renders one row of a view as the weighted sum of the pictures, each sampled where it shows the same point.
void render_row(const View& view, std::span<const PlacedImage> images, std::span<const float> disparity,
                const lightfield::Shape& shape, size_t y, std::span<float> row) {
  const size_t height = shape.height, width = shape.width;
  for (size_t x = 0; x < width; ++x) {
    const auto fy = static_cast<float>(y), fx = static_cast<float>(x);
    // The disparity is known at the centre. A first guess determines where the pixel of this view lies there.
    const float guess = disparity[y * width + x];
    const float d = sample_bilinear(disparity, height, width, fy - guess * static_cast<float>(view.y),
                                    fx - guess * static_cast<float>(view.x));
    float sum = 0;
    for (size_t n = 0; n < images.size(); ++n) {
      sum += view.weights[n] * sample_bilinear(images[n].pixels, height, width,
                                               fy + d * static_cast<float>(images[n].view_y - view.y),
                                               fx + d * static_cast<float>(images[n].view_x - view.x));
    }
    row[x] = sum;
  }
}

template <typename Images>
Result<void> check_not_empty(const Images& images) {
  if (images.image_size() > 0) return {};
  return fail(ErrorCode::kShape, "", "images of ", images.width, "x", images.height, " are empty; give some pixels");
}

/// Returns the number of the first black pattern.
Result<size_t> black_pattern(const capture::EventImages& images, const capture::Codes& codes) {
  const auto is_black = [&](size_t n) {
    return std::all_of(codes.pattern(n).begin(), codes.pattern(n).end(), [](float value) { return value == 0; });
  };
  size_t black = 0;
  while (black < codes.num_patterns && !is_black(black)) ++black;
  if (black == codes.num_patterns) {
    return fail(ErrorCode::kInvalidValue, "",
                "no pattern is black, so events do not determine intensities; use a trained model");
  }
  if (images.count + 1 != codes.num_patterns) {
    return fail(ErrorCode::kShape, "", images.count, " event images do not fit ", codes.num_patterns,
                " patterns; use the patterns that the events were recorded with");
  }
  E2LF_RETURN_IF_ERROR(check_not_empty(images));
  return black;
}

}  // namespace

std::vector<std::vector<double>> view_weights(const capture::Codes& codes, const ViewPrior& prior) {
  std::vector<size_t> lit;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    if (open_cells(codes.pattern(n)) > 0) lit.push_back(n);
  }
  E2LF_REQUIRE(!lit.empty(), "one pattern at least must let light through");

  const size_t size = lit.size(), views = codes.pattern_size();
  const Matrix with_views = correlations(codes, lit, prior.correlation_length);
  Matrix system(size + 1, std::vector<double>(size + 1, 1.0)), solution = with_views;
  system[size][size] = 0;
  for (size_t i = 0; i < size; ++i) {
    for (size_t j = 0; j < size; ++j) {
      const auto pattern = codes.pattern(lit[j]);
      double sum = 0;
      for (size_t view = 0; view < views; ++view) sum += with_views[i][view] * pattern[view];
      system[i][j] = sum / open_cells(pattern) + (i == j ? prior.noise : 0);
    }
  }
  solution.emplace_back(views, 1.0);
  solve(std::move(system), solution);

  Matrix weights(views, std::vector<double>(codes.num_patterns));
  for (size_t i = 0; i < size; ++i) {
    for (size_t view = 0; view < views; ++view) weights[view][lit[i]] = solution[i][view];
  }
  return weights;
}

Result<lightfield::LightField> linear_estimate(const capture::CodedIntensities& intensities,
                                               const capture::Codes& codes) {
  if (intensities.count != codes.num_patterns) {
    return fail(ErrorCode::kShape, "", "there are ", intensities.count, " coded images but ", codes.num_patterns,
                " patterns; use the patterns that the events were recorded with");
  }
  E2LF_RETURN_IF_ERROR(check_not_empty(intensities));
  const PlacedImages placed = place_images(intensities, codes);
  const std::vector<PlacedImage>& images = placed.images;
  const std::vector<size_t>& lit = placed.patterns;
  if (lit.empty()) return fail(ErrorCode::kInvalidValue, "", "every pattern is black; use patterns with open cells");

  lightfield::LightField light_field({codes.views_y, codes.views_x, intensities.height, intensities.width});
  const lightfield::Shape& shape = light_field.shape();
  const std::vector<float> disparity = coded_disparity(images, shape.height, shape.width);
  const auto weights = view_weights(codes, {});
  parallel_for(shape.num_views() * shape.height, 8, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t number = i / shape.height, y = i % shape.height;
      View view{static_cast<double>(number / shape.views_x) - view_centre(shape.views_y),
                static_cast<double>(number % shape.views_x) - view_centre(shape.views_x),
                {}};
      for (const size_t n : lit) view.weights.push_back(static_cast<float>(weights[number][n]));
      render_row(view, images, disparity, shape, y, light_field.data().subspan(i * shape.width, shape.width));
    }
  });
  return light_field;
}

Result<lightfield::LightField> reconstruct_by_inversion(const capture::EventImages& images, const capture::Codes& codes,
                                                        const capture::SensorConstants& constants) {
  constexpr size_t kDenoiseRadius = 3;
  InversionOptions inversion{.constants = constants, .centred = true};
  E2LF_ASSIGN_OR_RETURN(inversion.black, black_pattern(images, codes));
  E2LF_ASSIGN_OR_RETURN(capture::CodedIntensities intensities, invert_events(images, inversion));
  denoise_intensities(intensities, images, constants, kDenoiseRadius);
  return linear_estimate(intensities, codes);
}

}  // namespace e2lf::recon
