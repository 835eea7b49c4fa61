// SPDX-License-Identifier: MIT
#include "e2lf/eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"

namespace e2lf::eval {
namespace {

using lightfield::Shape;

std::string describe(const Shape& shape) {
  return shape_text({shape.views_y, shape.views_x, shape.height, shape.width, shape.channels});
}

Result<void> check_finite(const LightFieldView& light_field, const std::string& which) {
  const Shape shape = lightfield::shape_of(light_field);
  std::vector<float> scratch;
  for (size_t view = 0; view < shape.num_views(); ++view) {
    const auto values = light_field[view / shape.views_x][view % shape.views_x].values(scratch);
    if (std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) continue;
    return fail(ErrorCode::kInvalidValue, cat("view (", view / shape.views_x, ", ", view % shape.views_x, ")"), "the ",
                which, " has a value that is not finite; check what wrote it");
  }
  return {};
}

Result<void> check(const LightFieldView& truth, const LightFieldView& reconstruction) {
  const Shape shape = lightfield::shape_of(truth);
  if (shape != lightfield::shape_of(reconstruction)) {
    return fail(ErrorCode::kShape, "", "the light fields differ in shape: truth ", describe(shape), ", reconstruction ",
                describe(lightfield::shape_of(reconstruction)), "; crop or convert one of them");
  }
  const size_t smallest = ssim_window_size(SsimWindow::kGaussian11);
  if (shape.num_views() == 0 || shape.channels == 0 || shape.height < smallest || shape.width < smallest) {
    return fail(ErrorCode::kShape, "", "light field ", describe(shape), " is too small to measure; views need ",
                smallest, "x", smallest, " pixels");
  }
  E2LF_RETURN_IF_ERROR(check_finite(truth, "true light field"));
  return check_finite(reconstruction, "reconstruction");
}

/// Extracts one channel of an interleaved view as a plane [y, x].
std::vector<float> take_channel(std::span<const float> view, size_t channel, size_t channels) {
  std::vector<float> plane(view.size() / channels);
  for (size_t i = 0; i < plane.size(); ++i) plane[i] = view[i * channels + channel];
  return plane;
}

std::vector<float> measured_values(std::span<const float> reconstruction, bool clamp) {
  std::vector<float> measured(reconstruction.begin(), reconstruction.end());
  if (clamp) {
    for (float& value : measured) value = std::clamp(value, 0.0F, 1.0F);
  }
  return measured;
}

/// Calls body(number, true values, values) for each view, in several threads.
template <typename Body>
void for_each_view(const LightFieldView& truth, const LightFieldView& reconstruction, const Body& body) {
  const size_t columns = truth.extents[1];
  parallel_for(truth.extents[0] * columns, 1, [&](size_t begin, size_t end) {
    std::vector<float> scratch[2];
    for (size_t view = begin; view < end; ++view) {
      const size_t y = view / columns, x = view % columns;
      body(view, truth[y][x].values(scratch[0]), reconstruction[y][x].values(scratch[1]));
    }
  });
}

Metrics compare_views(std::span<const float> truth, std::span<const float> measured, const Shape& shape) {
  Metrics metrics;
  metrics.psnr_db = psnr_from_mse(mean_squared_error(truth, measured));
  for (size_t channel = 0; channel < shape.channels; ++channel) {
    const auto a = take_channel(truth, channel, shape.channels);
    const auto b = take_channel(measured, channel, shape.channels);
    metrics.ssim_uniform7 += ssim(a, b, shape.height, shape.width, SsimWindow::kUniform7);
    metrics.ssim_gaussian += ssim(a, b, shape.height, shape.width, SsimWindow::kGaussian11);
  }
  metrics.ssim_uniform7 /= static_cast<double>(shape.channels);
  metrics.ssim_gaussian /= static_cast<double>(shape.channels);
  return metrics;
}

Metrics mean_of(const std::vector<ViewMetrics>& views) {
  Metrics mean;
  for (const ViewMetrics& view : views) {
    mean.psnr_db += view.metrics.psnr_db;
    mean.ssim_uniform7 += view.metrics.ssim_uniform7;
    mean.ssim_gaussian += view.metrics.ssim_gaussian;
  }
  const auto count = static_cast<double>(views.size());
  return {mean.psnr_db / count, mean.ssim_uniform7 / count, mean.ssim_gaussian / count};
}

/// Sums over pixels and pairs of neighbouring views.
struct Sums {
  double error_squares = 0, truth_squares = 0;
  size_t count = 0;
};

/// Two neighbouring views that are compared in both light fields.
struct ViewPair {
  size_t view_y, view_x, next_y, next_x;
};

void add_pair(const LightFieldView& truth, const LightFieldView& reconstruction, const ViewPair& pair, bool clamp,
              Sums& sums) {
  std::vector<float> scratch[4];
  const auto truth_here = truth[pair.view_y][pair.view_x].values(scratch[0]);
  const auto truth_next = truth[pair.next_y][pair.next_x].values(scratch[1]);
  const auto here = reconstruction[pair.view_y][pair.view_x].values(scratch[2]);
  const auto next = reconstruction[pair.next_y][pair.next_x].values(scratch[3]);
  const float low = clamp ? 0.0F : std::numeric_limits<float>::lowest();
  const float high = clamp ? 1.0F : std::numeric_limits<float>::max();
  for (size_t i = 0; i < here.size(); ++i) {
    const double truth_change = double{truth_next[i]} - double{truth_here[i]};
    const double change = double{std::clamp(next[i], low, high)} - double{std::clamp(here[i], low, high)};
    sums.error_squares += (change - truth_change) * (change - truth_change);
    sums.truth_squares += truth_change * truth_change;
  }
  sums.count += here.size();
}

/// Calls body(true value, value) for all values in order.
template <typename Body>
void for_each_pair(const LightFieldView& truth, const LightFieldView& reconstruction, const Body& body) {
  E2LF_REQUIRE(truth.extents == reconstruction.extents, "light fields must have the same shape");
  std::vector<float> scratch[2];
  for (size_t view = 0; view < truth.extents[0] * truth.extents[1]; ++view) {
    const size_t view_y = view / truth.extents[1], view_x = view % truth.extents[1];
    const auto a = truth[view_y][view_x].values(scratch[0]), b = reconstruction[view_y][view_x].values(scratch[1]);
    for (size_t i = 0; i < a.size(); ++i) body(double{a[i]}, double{b[i]});
  }
}

}  // namespace

double mean_squared_error(std::span<const float> values_a, std::span<const float> values_b) {
  E2LF_REQUIRE(values_a.size() == values_b.size() && !values_a.empty(),
               "spans must have the same length, which is not zero");
  double sum = 0;
  for (size_t i = 0; i < values_a.size(); ++i) {
    const double difference = double{values_a[i]} - double{values_b[i]};
    sum += difference * difference;
  }
  return sum / static_cast<double>(values_a.size());
}

double psnr_from_mse(double mse) {
  return mse > 0 ? -10 * std::log10(mse) : std::numeric_limits<double>::infinity();
}

EpiError epi_error(const LightFieldView& truth, const LightFieldView& reconstruction, bool clamp) {
  E2LF_REQUIRE(truth.extents == reconstruction.extents, "light fields must have the same shape");
  const Shape shape = lightfield::shape_of(truth);
  std::vector<Sums> sums(shape.num_views());
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const size_t y = view / shape.views_x, x = view % shape.views_x;
      if (x + 1 < shape.views_x) add_pair(truth, reconstruction, {y, x, y, x + 1}, clamp, sums[view]);
      if (y + 1 < shape.views_y) add_pair(truth, reconstruction, {y, x, y + 1, x}, clamp, sums[view]);
    }
  });
  Sums total;
  for (const Sums& part : sums) {
    total.error_squares += part.error_squares;
    total.truth_squares += part.truth_squares;
    total.count += part.count;
  }
  if (total.error_squares == 0) return {};
  return {std::sqrt(total.error_squares / static_cast<double>(total.count)),
          std::sqrt(total.error_squares / total.truth_squares)};
}

Result<LightFieldMetrics> compare(const LightFieldView& truth, const LightFieldView& reconstruction, bool clamp,
                                  const ProgressFn& progress) {
  E2LF_RETURN_IF_ERROR(check(truth, reconstruction));
  const Shape shape = lightfield::shape_of(truth);
  LightFieldMetrics result;
  result.views.resize(shape.num_views());
  std::mutex mutex;
  size_t done = 0;
  for_each_view(truth, reconstruction,
                [&](size_t view, std::span<const float> expected, std::span<const float> values) {
                  result.views[view] = {view / shape.views_x, view % shape.views_x,
                                        compare_views(expected, measured_values(values, clamp), shape)};
                  const std::lock_guard lock(mutex);
                  ++done;
                  if (progress) progress(done, shape.num_views());
                });
  result.mean = mean_of(result.views);
  result.epi = epi_error(truth, reconstruction, clamp);
  return result;
}

std::vector<double> psnr_of_views(const LightFieldView& truth, const LightFieldView& reconstruction) {
  E2LF_REQUIRE(truth.extents == reconstruction.extents, "light fields of one shape are compared");
  std::vector<double> psnr_db(lightfield::shape_of(truth).num_views());
  for_each_view(truth, reconstruction,
                [&](size_t view, std::span<const float> expected, std::span<const float> values) {
                  psnr_db[view] = psnr_from_mse(mean_squared_error(expected, measured_values(values, /*clamp=*/true)));
                });
  return psnr_db;
}

float best_gain(const LightFieldView& truth, const LightFieldView& reconstruction) {
  double products = 0, squares = 0;
  for_each_pair(truth, reconstruction, [&](double true_value, double value) {
    products += value * true_value;
    squares += value * value;
  });
  return squares > 0 ? static_cast<float>(products / squares) : 0.0F;
}

Tone best_tone(const LightFieldView& truth, const LightFieldView& reconstruction) {
  double mean_truth = 0, mean_value = 0;
  for_each_pair(truth, reconstruction, [&](double true_value, double value) {
    mean_truth += true_value;
    mean_value += value;
  });
  const auto count = static_cast<double>(std::max<size_t>(truth.size(), 1));
  mean_truth /= count;
  mean_value /= count;
  double products = 0, squares = 0;
  for_each_pair(truth, reconstruction, [&](double true_value, double value) {
    squares += (value - mean_value) * (value - mean_value);
    products += (value - mean_value) * (true_value - mean_truth);
  });
  if (squares <= 0 || products <= 0) return {0.0F, static_cast<float>(mean_value)};
  const double gain = products / squares;
  return {static_cast<float>(gain), static_cast<float>(mean_value - mean_truth / gain)};
}

namespace {

constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

/// Returns the one-dimensional weights of a window, with sum 1. Both windows are separable.
std::vector<double> window_weights(SsimWindow window) {
  const size_t size = ssim_window_size(window);
  std::vector<double> weights(size, 1.0);
  if (window == SsimWindow::kGaussian11) {
    constexpr double kSigma = 1.5;
    const double centre = static_cast<double>(size - 1) / 2;
    for (size_t i = 0; i < size; ++i) {
      const double offset = (static_cast<double>(i) - centre) / kSigma;
      weights[i] = std::exp(-0.5 * offset * offset);
    }
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Windowed means of one row of windows: a, b, a^2 + b^2 (SSIM needs only the sum of the variances) and a * b.
struct MomentRows {
  explicit MomentRows(size_t width) : a(width), b(width), squares(width), product(width) {}
  std::vector<double> a, b, squares, product;
};

/// Filters vertically: computes the moments of each column over the rows of the window that starts at `image_*`.
void filter_columns(const float* image_a, const float* image_b, size_t width, const std::vector<double>& weights,
                    MomentRows& columns) {
  columns = MomentRows(width);
  for (size_t i = 0; i < weights.size(); ++i) {
    const float* row_a = image_a + i * width;
    const float* row_b = image_b + i * width;
    const double weight = weights[i];
    for (size_t x = 0; x < width; ++x) {
      const double a = row_a[x], b = row_b[x];
      columns.a[x] += weight * a;
      columns.b[x] += weight * b;
      columns.squares[x] += weight * (a * a + b * b);
      columns.product[x] += weight * (a * b);
    }
  }
}

/// Filters horizontally, for the windows that lie inside the row.
void filter_row(const std::vector<double>& columns, const std::vector<double>& weights, std::vector<double>& row) {
  std::fill(row.begin(), row.end(), 0.0);
  for (size_t i = 0; i < weights.size(); ++i) {
    const double* shifted = columns.data() + i;
    for (size_t x = 0; x < row.size(); ++x) row[x] += weights[i] * shifted[x];
  }
}

double sum_of_ssim(const MomentRows& moments, double covariance_scale) {
  double sum = 0;
  for (size_t x = 0; x < moments.a.size(); ++x) {
    const double means = moments.a[x] * moments.b[x];
    const double mean_squares = moments.a[x] * moments.a[x] + moments.b[x] * moments.b[x];
    const double variances = covariance_scale * (moments.squares[x] - mean_squares);
    const double covariance = covariance_scale * (moments.product[x] - means);
    sum += (2 * means + kC1) * (2 * covariance + kC2) / ((mean_squares + kC1) * (variances + kC2));
  }
  return sum;
}

}  // namespace

size_t ssim_window_size(SsimWindow window) {
  return window == SsimWindow::kUniform7 ? 7 : 11;
}

double ssim(std::span<const float> image_a, std::span<const float> image_b, size_t height, size_t width,
            SsimWindow window) {
  const size_t size = ssim_window_size(window);
  E2LF_REQUIRE(image_a.size() == height * width && image_b.size() == height * width, "images must be height * width");
  E2LF_REQUIRE(height >= size && width >= size, "an image must be as large as the SSIM window");
  const std::vector<double> weights = window_weights(window);
  const auto window_pixels = static_cast<double>(size * size);
  const double covariance_scale = window_pixels / (window_pixels - 1);
  const size_t rows = height - size + 1, columns_out = width - size + 1;

  MomentRows columns(width), moments(columns_out);
  double sum = 0;
  for (size_t y = 0; y < rows; ++y) {
    filter_columns(image_a.data() + y * width, image_b.data() + y * width, width, weights, columns);
    filter_row(columns.a, weights, moments.a);
    filter_row(columns.b, weights, moments.b);
    filter_row(columns.squares, weights, moments.squares);
    filter_row(columns.product, weights, moments.product);
    sum += sum_of_ssim(moments, covariance_scale);
  }
  return sum / static_cast<double>(rows * columns_out);
}

EventStatistics event_cost(double total_events_per_pixel) {
  constexpr double kEventsPerPixelPerS = 1.066e9 / (1280.0 * 720.0), kBitsPerEvent = 29, kViews = 64;
  const double bits = total_events_per_pixel * kBitsPerEvent;
  return {.events_per_pixel = {},
          .total_events_per_pixel = total_events_per_pixel,
          .min_measurement_ms = 1e3 * total_events_per_pixel / kEventsPerPixelPerS,
          .bits_per_sensor_pixel = bits,
          .bits_per_light_field_pixel = bits / kViews,
          .events_per_light_field_pixel = total_events_per_pixel / kViews};
}

EventStatistics event_statistics(const PlanesView<const int16_t>& images) {
  E2LF_REQUIRE(images.size() > 0, "event images need pixels");
  std::vector<double> events_per_pixel;
  for (size_t transition = 0; transition < images.extents[0]; ++transition) {
    uint64_t events = 0;
    for_each_value(images[transition], [&](int16_t count) { events += static_cast<uint64_t>(std::abs(int{count})); });
    events_per_pixel.push_back(static_cast<double>(events) / static_cast<double>(images[transition].size()));
  }
  auto statistics = event_cost(std::accumulate(events_per_pixel.begin(), events_per_pixel.end(), 0.0));
  statistics.events_per_pixel = std::move(events_per_pixel);
  return statistics;
}

}  // namespace e2lf::eval
