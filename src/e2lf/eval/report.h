// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

#include "e2lf/depth/disparity_error.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/files/options.h"
#include "e2lf/report/table.h"

namespace e2lf::eval {

/// One row of a table: a method on a scene.
struct EvalRow {
  std::string method, scene;
  LightFieldMetrics quality;
  std::optional<EventStatistics> events = {};   ///< absent if only pictures were compared
  std::optional<double> gain = {}, black = {};  ///< tone that was applied when the reconstruction was made
  std::optional<double> fitted_gain = {}, fitted_black = {};  ///< tone that was applied for the comparison: best_tone()
  std::optional<depth::DisparityError> disparity = {};        ///< absent if there is no disparity to compare
};

/// Returns {"psnr_db", "ssim_uniform7", "ssim_gaussian", "epi_rms_error", "epi_relative_error", "views": [{"view_y",
/// "view_x", and the first three}]}. The infinite PSNR of identical pictures is null, because JSON has no infinity.
[[nodiscard]] Json to_json(const LightFieldMetrics& quality);

/// Returns {"events_per_pixel", "total_events_per_pixel", "min_measurement_ms", "bits_per_sensor_pixel", ...}, with the
/// names of the fields.
[[nodiscard]] Json to_json(const EventStatistics& events);

/// Returns {"bad_07_percent", "bad_20_percent", "mean_absolute_px", "slope", "num_pixels", "most_certain":
/// [{"pixels_percent", "bad_20_percent", "mean_absolute_px"}]}.
[[nodiscard]] Json to_json(const depth::DisparityError& error);

/// Returns {"method", "scene", the keys of the quality, and "events", "disparity" and those of gains and black levels
/// if present}.
[[nodiscard]] Json to_json(const EvalRow& row);

/// Makes a table with one line per row. The columns for events, gains and disparities exist if any row has them. The
/// infinite PSNR of identical pictures reads "inf" and has no value.
[[nodiscard]] report::Table quality_table(std::span<const EvalRow> rows);

/// Formats the PSNR of each view in dB in the order of the aperture, with one text line per row of views.
[[nodiscard]] std::string view_grid_text(const LightFieldMetrics& quality);

}  // namespace e2lf::eval
