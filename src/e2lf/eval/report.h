// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/files/options.h"

namespace e2lf::eval {

/// One line of a table: a method on a scene.
struct EvalRow {
  std::string method, scene;
  LightFieldMetrics quality;
  std::optional<EventStatistics> events;  ///< absent when only pictures were compared
};

/// {"psnr_db", "ssim_uniform7", "ssim_gaussian", "epi_rms_error", "epi_relative_error", "views": [{"view_y", "view_x",
/// and the first three}]}. The infinite PSNR of equal pictures is null: JSON has no infinity.
[[nodiscard]] Json to_json(const LightFieldMetrics& quality);

/// {"events_per_pixel", "total_events_per_pixel", "min_measurement_ms", "bits_per_sensor_pixel", ...}: the field names.
[[nodiscard]] Json to_json(const EventStatistics& events);

/// {"method", "scene", the keys of the quality, "events": ... or absent}.
[[nodiscard]] Json to_json(const EvalRow& row);

/// A table for the terminal with a heading, one line for each row, and columns of even width. The columns for events
/// are there when any row has them.
[[nodiscard]] std::string table_text(std::span<const EvalRow> rows);

/// The PSNR of each view in dB, in the order of the aperture: one text line for each row of views.
[[nodiscard]] std::string view_grid_text(const LightFieldMetrics& quality);

/// Comma-separated values (RFC 4180) with a heading; cells without a value are empty.
[[nodiscard]] std::string csv_text(std::span<const EvalRow> rows);

/// `method & 28.40/0.8330 & ... \\`: PSNR/SSIM (7x7 window) of one method on each scene, as in the tables of the field.
[[nodiscard]] std::string latex_row(const std::string& method, std::span<const EvalRow> scenes);

}  // namespace e2lf::eval
