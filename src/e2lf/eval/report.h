// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/files/options.h"
#include "e2lf/report/table.h"

namespace e2lf::eval {

/// One line of a table: a method on a scene.
struct EvalRow {
  std::string method, scene;
  LightFieldMetrics quality;
  std::optional<EventStatistics> events = {};  ///< absent when only pictures were compared
  std::optional<double> gain = {};             ///< that the reconstruction was multiplied with when it was made
  std::optional<double> fitted_gain = {};      ///< and to compare it: best_gain()
};

/// {"psnr_db", "ssim_uniform7", "ssim_gaussian", "epi_rms_error", "epi_relative_error", "views": [{"view_y", "view_x",
/// and the first three}]}. The infinite PSNR of equal pictures is null: JSON has no infinity.
[[nodiscard]] Json to_json(const LightFieldMetrics& quality);

/// {"events_per_pixel", "total_events_per_pixel", "min_measurement_ms", "bits_per_sensor_pixel", ...}: the field names.
[[nodiscard]] Json to_json(const EventStatistics& events);

/// {"method", "scene", the keys of the quality, "events", "gain", "fitted_gain": ... or absent}.
[[nodiscard]] Json to_json(const EvalRow& row);

/// A line for each row; the columns for events and for gains are there when any row has them. The infinite PSNR of
/// equal pictures reads "inf" and has no value.
[[nodiscard]] report::Table quality_table(std::span<const EvalRow> rows);

/// The PSNR of each view in dB, in the order of the aperture: one text line for each row of views.
[[nodiscard]] std::string view_grid_text(const LightFieldMetrics& quality);

}  // namespace e2lf::eval
