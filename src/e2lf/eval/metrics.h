// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::eval {

/// Computes the mean of (a - b)^2 over all values, summed in double. Spans that are empty or of different lengths break
/// the contract.
[[nodiscard]] double mean_squared_error(std::span<const float> values_a, std::span<const float> values_b);

/// Returns the peak signal-to-noise ratio 10 log10(1 / mse) for values in [0, 1], which is infinite for an mse of 0.
[[nodiscard]] double psnr_from_mse(double mse);

/// Measures how faithfully the changes from view to view, i.e. the lines of the epipolar plane images, are preserved.
/// With the difference D = L(v + 1) - L(v) between neighbouring views v (in rows and in columns of the aperture):
struct EpiError {
  double rms = 0;       ///< root mean square of D_reconstruction - D_truth over all pixels and pairs
  double relative = 0;  ///< rms / root mean square of D_truth; 0 is perfect, 1 is the same picture in all views
};

/// Compares the view-to-view changes of two light fields of the same shape. `clamp` limits the reconstruction to [0,
/// 1]. An error that is the same in every view does not count. Without neighbouring views, both figures are 0. If the
/// truth does not change from view to view but the reconstruction does, `relative` is infinite. Different shapes break
/// the contract.
[[nodiscard]] EpiError epi_error(const LightFieldView& truth, const LightFieldView& reconstruction, bool clamp);

/// The metrics of one view, or their means. For colour, PSNR is computed over all channels and SSIM is averaged over
/// them.
struct Metrics {
  double psnr_db = 0;
  double ssim_uniform7 = 0;  ///< ssim.h, SsimWindow::kUniform7
  double ssim_gaussian = 0;  ///< ssim.h, SsimWindow::kGaussian11
};

struct ViewMetrics {
  size_t view_y = 0, view_x = 0;
  Metrics metrics;
};

/// The quality of a reconstructed light field: the metrics of each view and their arithmetic mean over the views (of
/// PSNR in decibels, as in papers).
struct LightFieldMetrics {
  Metrics mean;
  EpiError epi;
  std::vector<ViewMetrics> views;  ///< in view order
};

/// Compares a reconstruction with the true light field. Float values are used as they are, without rounding to 8 bits;
/// `clamp` limits the reconstruction to [0, 1] first, as saving it as a picture would. The views are distributed among
/// threads; the figures do not depend on their number. Fails with kShape (different shapes, or views smaller than
/// 11x11) and kInvalidValue (NaN or infinity; the location names the view).
[[nodiscard]] Result<LightFieldMetrics> compare(const LightFieldView& truth, const LightFieldView& reconstruction,
                                                bool clamp = true, const ProgressFn& progress = {});

/// Computes the PSNR of each view, in view order, as compare() does for any size of views. It is infinite for equal
/// views. Different shapes break the contract.
[[nodiscard]] std::vector<double> psnr_of_views(const LightFieldView& truth, const LightFieldView& reconstruction);

/// Returns the factor g that minimises the squared error between the truth and g times the reconstruction, so that a
/// method made for another brightness is not penalised for that alone. It is 0 for a black reconstruction. Different
/// shapes break the contract.
[[nodiscard]] float best_gain(const LightFieldView& truth, const LightFieldView& reconstruction);

/// The brightness (value - black) * gain of a light field.
struct Tone {
  float gain = 1.0F, black = 0.0F;
};

/// Returns the tone of the reconstruction that minimises the squared error from the truth. The gain is 0 for a
/// reconstruction without contrast. Different shapes break the contract.
[[nodiscard]] Tone best_tone(const LightFieldView& truth, const LightFieldView& reconstruction);

/// The two variants of SSIM used in light-field papers (Wang et al., "Image quality assessment", TIP 2004), as computed
/// by scikit-image with data_range 1, K1 = 0.01, K2 = 0.03 and sample covariance (NP / (NP - 1), where NP is the number
/// of pixels of the window).
enum class SsimWindow {
  kUniform7,   ///< 7x7 mean, the default of scikit-image
  kGaussian11  ///< Gaussian with sigma 1.5 px, truncated at a radius of 5 px: gaussian_weights=True
};

/// Returns the side length of the window in px, 7 or 11. SSIM is not defined for smaller images.
[[nodiscard]] size_t ssim_window_size(SsimWindow window);

/// Computes the mean SSIM of two images [y, x] of the same size with values in [0, 1], over the pixels whose window
/// lies inside the image, so that border handling is irrelevant. It is computed in double, symmetric in the two images,
/// and 1 for equal images. Spans whose size is not height * width, or an image smaller than the window, break the
/// contract.
[[nodiscard]] double ssim(std::span<const float> image_a, std::span<const float> image_b, size_t height, size_t width,
                          SsimWindow window);

/// The cost of a measurement in events, time and data, with the figures of the paper: a Prophesee EVK4 with 1280x720 px
/// and a throughput of 1.066e9 events/s, 29 bits per event in coordinate (COO) form, and 64 views.
struct EventStatistics {
  std::vector<double> events_per_pixel;  ///< mean of |E| for each transition
  double total_events_per_pixel = 0;     ///< their sum
  double min_measurement_ms = 0;  ///< total / (throughput per pixel), the lower limit for a sensor of this throughput
  double bits_per_sensor_pixel = 0;         ///< total * bits per event
  double bits_per_light_field_pixel = 0;    ///< bits_per_sensor_pixel / number of views
  double events_per_light_field_pixel = 0;  ///< total / number of views
};

/// Counts the events of one cycle. An event image holds the sum of signed events, in which ON and OFF events of a pixel
/// within one transition cancel. The figures are therefore lower bounds for noisy recordings. Images without pixels
/// break the contract.
[[nodiscard]] EventStatistics event_statistics(const PlanesView<const int16_t>& images);

/// Computes time and data rate for a known number of events per pixel. `events_per_pixel` is left empty.
[[nodiscard]] EventStatistics event_cost(double total_events_per_pixel);

}  // namespace e2lf::eval
