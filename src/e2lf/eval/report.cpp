// SPDX-License-Identifier: MIT
#include "e2lf/eval/report.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"

namespace e2lf::eval {
namespace {

void add_metrics(const Metrics& metrics, Json& json) {
  json["psnr_db"] = finite_or_null(metrics.psnr_db);
  json["ssim_uniform7"] = finite_or_null(metrics.ssim_uniform7);
  json["ssim_gaussian"] = finite_or_null(metrics.ssim_gaussian);
}

report::Cell quality_cell(double value, int decimals) {
  return std::isinf(value) ? report::Cell{"inf", nullptr} : report::number_cell(value, decimals);
}

struct ToneColumn {
  const char *name, *key;
  std::optional<double> EvalRow::*value;
};
constexpr ToneColumn kTones[] = {{"gain", "gain", &EvalRow::gain},
                                 {"black", "black", &EvalRow::black},
                                 {"fitted gain", "fitted_gain", &EvalRow::fitted_gain},
                                 {"fitted black", "fitted_black", &EvalRow::fitted_black}};

}  // namespace

Json to_json(const LightFieldMetrics& quality) {
  Json json;
  add_metrics(quality.mean, json);
  json["epi_rms_error"] = finite_or_null(quality.epi.rms);
  json["epi_relative_error"] = finite_or_null(quality.epi.relative);
  json["views"] = Json::array();
  for (const ViewMetrics& view : quality.views) {
    Json entry{{"view_y", view.view_y}, {"view_x", view.view_x}};
    add_metrics(view.metrics, entry);
    json["views"].push_back(std::move(entry));
  }
  return json;
}

Json to_json(const EventStatistics& events) {
  FieldWriter writer;
  E2LF_VISIT(events, writer, events_per_pixel, total_events_per_pixel, min_measurement_ms, bits_per_sensor_pixel,
             bits_per_light_field_pixel, events_per_light_field_pixel);
  return std::move(writer).json();
}

Json to_json(const depth::DisparityError& error) {
  FieldWriter writer;
  E2LF_VISIT(error, writer, bad_07_percent, bad_20_percent, mean_absolute_px, slope, num_pixels);
  writer.list("most_certain", error.most_certain, [](const auto& part, auto& inner) {
    E2LF_VISIT(part, inner, pixels_percent, bad_20_percent, mean_absolute_px);
  });
  return std::move(writer).json();
}

Json to_json(const EvalRow& row) {
  Json json{{"method", row.method}, {"scene", row.scene}};
  json.update(to_json(row.quality));
  if (row.events) json["events"] = to_json(*row.events);
  for (const auto& [name, key, member] : kTones) {
    if (row.*member) json[key] = *(row.*member);
  }
  if (row.disparity) json["disparity"] = to_json(*row.disparity);
  return json;
}

report::Table quality_table(std::span<const EvalRow> rows) {
  const auto has = [&](auto member) {
    return std::any_of(rows.begin(), rows.end(), [member](const EvalRow& row) { return (row.*member).has_value(); });
  };
  report::Table table;
  table.rows.resize(rows.size());
  const auto add = [&](const char* name, const char* key, const auto& cell_of) {
    table.columns.push_back({name, table.columns.size() > 1, false, key});
    for (size_t i = 0; i < rows.size(); ++i) table.rows[i].push_back(cell_of(rows[i]));
  };
  const auto add_quality = [&](const char* name, const char* key, double Metrics::*member, int decimals) {
    add(name, key, [&](const EvalRow& row) { return quality_cell(row.quality.mean.*member, decimals); });
  };
  /// Adds a column of a part that rows may lack.
  const auto add_of = [&](auto part, const char* name, const char* key, auto member, int decimals) {
    add(name, key, [&](const EvalRow& row) {
      return row.*part ? report::number_cell((*(row.*part)).*member, decimals) : report::Cell();
    });
  };
  add("method", "method", [](const EvalRow& row) { return report::text_cell(row.method); });
  add("scene", "scene", [](const EvalRow& row) { return report::text_cell(row.scene); });
  add_quality("PSNR dB", "psnr_db", &Metrics::psnr_db, 2);
  add_quality("SSIM 7x7", "ssim_uniform7", &Metrics::ssim_uniform7, 4);
  add_quality("SSIM Gauss", "ssim_gaussian", &Metrics::ssim_gaussian, 4);
  add("EPI error", "epi_relative_error", [](const EvalRow& row) { return quality_cell(row.quality.epi.relative, 3); });
  if (has(&EvalRow::disparity)) {
    using depth::DisparityError;
    add_of(&EvalRow::disparity, "disparity > 0.07 px, %", "bad_07_percent", &DisparityError::bad_07_percent, 1);
    add_of(&EvalRow::disparity, "disparity > 0.2 px, %", "bad_20_percent", &DisparityError::bad_20_percent, 1);
    add_of(&EvalRow::disparity, "disparity error, px", "mean_absolute_px", &DisparityError::mean_absolute_px, 3);
    add_of(&EvalRow::disparity, "disparity slope", "slope", &DisparityError::slope, 2);
  }
  for (const auto& [name, key, member] : kTones) {
    if (!has(member)) continue;
    add(name, key, [tone = member](const EvalRow& row) {
      return row.*tone ? report::number_cell(*(row.*tone), 3) : report::Cell();
    });
  }
  if (has(&EvalRow::events)) {
    add_of(&EvalRow::events, "events/px", "events_per_pixel", &EventStatistics::total_events_per_pixel, 3);
    add_of(&EvalRow::events, "min ms", "min_measurement_ms", &EventStatistics::min_measurement_ms, 2);
    add_of(&EvalRow::events, "bits/LF px", "bits_per_light_field_pixel", &EventStatistics::bits_per_light_field_pixel,
           2);
  }
  return table;
}

std::string view_grid_text(const LightFieldMetrics& quality) {
  std::string text;
  for (size_t i = 0; i < quality.views.size(); ++i) {
    const bool new_line = i > 0 && quality.views[i].view_y != quality.views[i - 1].view_y;
    text += new_line ? "\n" : (i > 0 ? " " : "");
    text += formatted("%.2f", quality.views[i].metrics.psnr_db);
  }
  return text + "\n";
}

}  // namespace e2lf::eval
