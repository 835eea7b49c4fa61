// SPDX-License-Identifier: MIT
#include "e2lf/recon/regularised.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/threads.h"
#include "e2lf/recon/denoise.h"
#include "e2lf/recon/inversion.h"
#include "e2lf/recon/placed_images.h"

namespace e2lf::recon {
namespace {

using Plane = std::vector<float>;  // [y, x]

constexpr float kBrightest = 1.5F;
constexpr size_t kSumParts =
    8;  // number of partial sums over views; it is fixed, so that threads do not change the order

/// The four pixels around a position and their bilinear weights.
struct Taps {
  size_t at[4];
  float weight[4];

  Taps(float y, float x, size_t height, size_t width) {
    y = std::clamp(y, 0.0F, static_cast<float>(height - 1));
    x = std::clamp(x, 0.0F, static_cast<float>(width - 1));
    const auto y0 = static_cast<size_t>(y), x0 = static_cast<size_t>(x);
    const size_t y1 = std::min(y0 + 1, height - 1), x1 = std::min(x0 + 1, width - 1);
    const float fy = y - static_cast<float>(y0), fx = x - static_cast<float>(x0);
    at[0] = y0 * width + x0, at[1] = y0 * width + x1, at[2] = y1 * width + x0, at[3] = y1 * width + x1;
    weight[0] = (1 - fy) * (1 - fx), weight[1] = (1 - fy) * fx, weight[2] = fy * (1 - fx), weight[3] = fy * fx;
  }
};

/// A view that is opened by at least one pattern.
struct OpenView {
  float y = 0, x = 0;  ///< relative to the centre of the views
  Plane disparity;
  std::vector<float> share;  ///< for each active pattern: transmittance / number of views
};

/// Maps a picture that all views show, shifted by its disparity, to coded intensities. The map is linear in the
/// picture.
class CodedPicture {
 public:
  CodedPicture(const capture::Codes& codes, const std::vector<size_t>& patterns, const Plane& disparity, size_t height,
               size_t width)
      : height_(height), width_(width), num_patterns_(patterns.size()) {
    for (size_t view = 0; view < codes.pattern_size(); ++view) {
      OpenView open;
      for (const size_t n : patterns) {
        open.share.push_back(codes.pattern(n)[view] / static_cast<float>(codes.pattern_size()));
      }
      if (std::all_of(open.share.begin(), open.share.end(), [](float share) { return share == 0; })) continue;
      open.y = static_cast<float>(static_cast<double>(view / codes.views_x) - view_centre(codes.views_y));
      open.x = static_cast<float>(static_cast<double>(view % codes.views_x) - view_centre(codes.views_x));
      views_.push_back(std::move(open));
    }
    parallel_for(views_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        views_[i].disparity = disparity_in_view(disparity, height, width, double{views_[i].y}, double{views_[i].x});
      }
    });
  }

  [[nodiscard]] size_t num_patterns() const { return num_patterns_; }

  /// Computes the coded intensities, one plane per pattern.
  [[nodiscard]] std::vector<Plane> forward(const Plane& picture) const {
    std::vector<Plane> coded(num_patterns_, Plane(picture.size()));
    parallel_for(height_, 4, [&](size_t begin, size_t end) {
      for (const OpenView& view : views_) {
        for (size_t p = begin * width_; p < end * width_; ++p) {
          const Taps taps = taps_of(view, p);
          float value = 0;
          for (size_t t = 0; t < 4; ++t) value += taps.weight[t] * picture[taps.at[t]];
          for (size_t n = 0; n < num_patterns_; ++n) coded[n][p] += view.share[n] * value;
        }
      }
    });
    return coded;
  }

  /// Applies the transposed operator.
  [[nodiscard]] Plane backward(const std::vector<Plane>& coded) const {
    std::vector<Plane> parts(kSumParts, Plane(height_ * width_));
    parallel_for(kSumParts, 1, [&](size_t begin, size_t end) {
      for (size_t part = begin; part < end; ++part) {
        for (size_t i = part; i < views_.size(); i += kSumParts) add_backward(views_[i], coded, parts[part]);
      }
    });
    for (size_t part = 1; part < kSumParts; ++part) {
      for (size_t p = 0; p < parts[0].size(); ++p) parts[0][p] += parts[part][p];
    }
    return std::move(parts[0]);
  }

 private:
  [[nodiscard]] Taps taps_of(const OpenView& view, size_t p) const {
    const float d = view.disparity[p];
    return {static_cast<float>(p / width_) - d * view.y, static_cast<float>(p % width_) - d * view.x, height_, width_};
  }

  void add_backward(const OpenView& view, const std::vector<Plane>& coded, Plane& sum) const {
    for (size_t p = 0; p < sum.size(); ++p) {
      float value = 0;
      for (size_t n = 0; n < num_patterns_; ++n) value += view.share[n] * coded[n][p];
      const Taps taps = taps_of(view, p);
      for (size_t t = 0; t < 4; ++t) sum[taps.at[t]] += taps.weight[t] * value;
    }
  }

  size_t height_, width_, num_patterns_;
  std::vector<OpenView> views_;
};

/// The coded intensities of the active patterns as determined by the counts.
struct Observation {
  std::vector<Plane> lower, upper, weight;  ///< the ends of the interval, and 1 / variance of the noise
};

/// Derives the intervals and weights. The noise is that of the logarithm, so its standard deviation grows with the
/// intensity. The smoothed images are used for it, because dark outliers would otherwise get too much weight.
Observation observe(const capture::CodedIntensities& centred, const capture::CodedIntensities& smooth,
                    const std::vector<size_t>& patterns, const capture::EventImages& images,
                    const capture::SensorConstants& constants) {
  const float eps = constants.eps, half_step = std::exp(constants.tau / 2);
  Observation observation;
  for (const size_t n : patterns) {
    Plane lower, upper, weight;
    for (size_t p = 0; p < images.image_size(); ++p) {
      const float level = std::max(centred.image(n)[p], 0.0F) + eps;
      const float mean = std::max(smooth.image(n)[p], 0.0F) + eps;
      const float threshold_noise = n > 0 ? constants.sigma_z * static_cast<float>(images.image(n - 1)[p]) : 0.0F;
      // Without noise, the interval would be a hard constraint; a tenth of a threshold softens it.
      const float deviation =
          mean * std::sqrt(constants.sigma_w * constants.sigma_w + threshold_noise * threshold_noise +
                           0.01F * constants.tau * constants.tau);
      lower.push_back(level / half_step - eps);
      upper.push_back(level * half_step - eps);
      weight.push_back(1 / (deviation * deviation));
    }
    observation.lower.push_back(std::move(lower));
    observation.upper.push_back(std::move(upper));
    observation.weight.push_back(std::move(weight));
  }
  return observation;
}

/// Computes the gradient of the data term.
Plane data_gradient(const CodedPicture& coded, const Observation& observation, const Plane& picture) {
  std::vector<Plane> residuals = coded.forward(picture);
  for (size_t n = 0; n < residuals.size(); ++n) {
    for (size_t p = 0; p < picture.size(); ++p) {
      const float value = residuals[n][p];
      residuals[n][p] =
          observation.weight[n][p] * (value - std::clamp(value, observation.lower[n][p], observation.upper[n][p]));
    }
  }
  return coded.backward(residuals);
}

/// Computes an upper bound of the curvature of the data term at each pixel from its row sums.
Plane curvature(const CodedPicture& coded, const Observation& observation) {
  std::vector<Plane> weighted = coded.forward(Plane(observation.weight[0].size(), 1.0F));
  for (size_t n = 0; n < weighted.size(); ++n) {
    for (size_t p = 0; p < weighted[n].size(); ++p) weighted[n][p] *= observation.weight[n][p];
  }
  return coded.backward(weighted);
}

/// The dual variable of the total variation: a vector at each pixel, not longer than `longest`.
struct Dual {
  Plane y, x;

  explicit Dual(size_t size) : y(size), x(size) {}

  /// Adds `step` times the differences to the next pixels, and shortens vectors that are too long.
  void ascend(const Plane& picture, size_t height, size_t width, float step, float longest) {
    for (size_t row = 0; row < height; ++row) {
      for (size_t column = 0; column < width; ++column) {
        const size_t p = row * width + column;
        if (row + 1 < height) y[p] += step * (picture[p + width] - picture[p]);
        if (column + 1 < width) x[p] += step * (picture[p + 1] - picture[p]);
        const float length = std::sqrt(y[p] * y[p] + x[p] * x[p]);
        if (length <= longest) continue;
        y[p] *= longest / length;
        x[p] *= longest / length;
      }
    }
  }

  /// Returns the transposed differences at a pixel.
  [[nodiscard]] float transposed(size_t p, size_t width) const {
    return (p >= width ? y[p - width] : 0.0F) - y[p] + (p % width > 0 ? x[p - 1] : 0.0F) - x[p];
  }
};

/// Runs the iteration of Condat and Vu with a step size per pixel.
Plane minimise(const CodedPicture& coded, const Observation& observation, Plane picture, size_t height, size_t width,
               const RegularisedOptions& options, const ProgressFn& progress) {
  const Plane bound = curvature(coded, observation);
  double sum = 0;
  for (const float value : bound) sum += double{value};
  const float dual_step = static_cast<float>(sum / static_cast<double>(bound.size()) / 16);
  Dual dual(picture.size());
  Plane doubled(picture.size());
  for (size_t i = 0; i < options.iterations; ++i) {
    const Plane gradient = data_gradient(coded, observation, picture);
    for (size_t p = 0; p < picture.size(); ++p) {
      // The squared norm of the difference operator is at most 8.
      const float step = 1 / (bound[p] / 2 + 8 * dual_step);
      const float moved = std::clamp(picture[p] - step * (gradient[p] + dual.transposed(p, width)), 0.0F, kBrightest);
      doubled[p] = 2 * moved - picture[p];
      picture[p] = moved;
    }
    dual.ascend(doubled, height, width, dual_step, options.smoothness);
    if (progress) progress(i + 1, options.iterations);
  }
  return picture;
}

/// Returns the mean of the placed images, shifted to the centre of the views.
Plane first_guess(const std::vector<PlacedImage>& images, const Plane& disparity, size_t height, size_t width) {
  Plane guess(disparity.size());
  for (const PlacedImage& image : images) {
    for (size_t p = 0; p < guess.size(); ++p) {
      const float d = disparity[p];
      guess[p] += sample_bilinear(image.pixels, height, width,
                                  static_cast<float>(p / width) + d * static_cast<float>(image.view_y),
                                  static_cast<float>(p % width) + d * static_cast<float>(image.view_x)) /
                  static_cast<float>(images.size());
    }
  }
  return guess;
}

lightfield::LightField render(const Plane& picture, const Plane& disparity, const lightfield::Shape& shape) {
  lightfield::LightField field(shape);
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t number = begin; number < end; ++number) {
      const size_t row = number / shape.views_x, column = number % shape.views_x;
      const double view_y = static_cast<double>(row) - view_centre(shape.views_y);
      const double view_x = static_cast<double>(column) - view_centre(shape.views_x);
      const Plane seen = disparity_in_view(disparity, shape.height, shape.width, view_y, view_x);
      const auto view = field.view(row, column);
      for (size_t p = 0; p < view.size(); ++p) {
        view[p] = sample_bilinear(picture, shape.height, shape.width,
                                  static_cast<float>(p / shape.width) - seen[p] * static_cast<float>(view_y),
                                  static_cast<float>(p % shape.width) - seen[p] * static_cast<float>(view_x));
      }
    }
  });
  return field;
}

}  // namespace

Result<lightfield::LightField> reconstruct_regularised(const capture::EventImages& images, const capture::Codes& codes,
                                                       const capture::SensorConstants& constants,
                                                       const RegularisedOptions& options, const ProgressFn& progress) {
  InversionOptions inversion;
  inversion.constants = constants;
  inversion.centred = true;
  E2LF_ASSIGN_OR_RETURN(inversion.black, black_pattern(images, codes));
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities centred, invert_events(images, inversion));
  capture::CodedIntensities smooth = centred;
  denoise_intensities(smooth, images, constants, options.denoise_radius);
  const PlacedImages placed = place_images(smooth, codes);
  if (placed.images.empty()) {
    return Error{ErrorCode::kInvalidValue, "every pattern is black; use patterns with open cells", ""};
  }
  const size_t height = images.height, width = images.width;
  const Plane disparity = coded_disparity(placed.images, height, width, options.search);
  const CodedPicture coded(codes, placed.patterns, disparity, height, width);
  const Observation observation = observe(centred, smooth, placed.patterns, images, constants);
  const Plane picture = minimise(coded, observation, first_guess(placed.images, disparity, height, width), height,
                                 width, options, progress);
  return render(picture, disparity, {codes.views_y, codes.views_x, height, width});
}

}  // namespace e2lf::recon
