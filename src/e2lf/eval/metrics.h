// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/eval/epi_error.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::eval {

/// Mean of (a - b)^2 over all values, summed in double. Spans of different or no length break the contract.
[[nodiscard]] double mean_squared_error(std::span<const float> values_a, std::span<const float> values_b);

/// Peak signal-to-noise ratio 10 log10(1 / mse) for values in [0, 1]; infinity for an mse of 0.
[[nodiscard]] double psnr_from_mse(double mse);

struct MetricOptions {
  bool clamp = true;  ///< clamp the reconstruction to [0, 1] before measuring, as a saved picture is
};

/// The figures of one view, or their means. Colour: PSNR over all channels, SSIM averaged over them.
struct Metrics {
  double psnr_db = 0;
  double ssim_uniform7 = 0;  ///< ssim.h, SsimWindow::kUniform7
  double ssim_gaussian = 0;  ///< ssim.h, SsimWindow::kGaussian11
};

struct ViewMetrics {
  size_t view_y = 0, view_x = 0;
  Metrics metrics;
};

/// How well a light field was reconstructed: each view, and the plain mean over views (of the decibels, as papers do).
struct LightFieldMetrics {
  Metrics mean;
  EpiError epi;
  std::vector<ViewMetrics> views;  ///< in view order
};

/// Compares a reconstruction with the true light field; float values are used as they are, nothing is rounded to 8
/// bits. Views are shared among threads; the figures do not depend on their number. Fails with kShape (different
/// shapes, or views smaller than 11x11) and kInvalidValue (NaN or infinity, naming the view).
[[nodiscard]] Result<LightFieldMetrics> compare(const lightfield::LightField& truth,
                                                const lightfield::LightField& reconstruction,
                                                const MetricOptions& options = {}, const ProgressFn& progress = {});

}  // namespace e2lf::eval
