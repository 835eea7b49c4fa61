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

/// A column of the table: its heading, its name for programs, the place of its value in the JSON of a row, and
/// decimals.
struct QualityColumn {
  const char *name, *key, *place;
  int decimals;
};
constexpr QualityColumn kColumns[] = {
    {"PSNR dB", "psnr_db", "/psnr_db", 2},
    {"SSIM 7x7", "ssim_uniform7", "/ssim_uniform7", 4},
    {"SSIM Gauss", "ssim_gaussian", "/ssim_gaussian", 4},
    {"EPI error", "epi_relative_error", "/epi_relative_error", 3},
    {"disparity > 0.07 px, %", "bad_07_percent", "/disparity/bad_07_percent", 1},
    {"disparity > 0.2 px, %", "bad_20_percent", "/disparity/bad_20_percent", 1},
    {"disparity error, px", "mean_absolute_px", "/disparity/mean_absolute_px", 3},
    {"disparity slope", "slope", "/disparity/slope", 2},
    {"gain", "gain", "/gain", 3},
    {"black", "black", "/black", 3},
    {"fitted gain", "fitted_gain", "/fitted_gain", 3},
    {"fitted black", "fitted_black", "/fitted_black", 3},
    {"events/px", "events_per_pixel", "/events/total_events_per_pixel", 3},
    {"min ms", "min_measurement_ms", "/events/min_measurement_ms", 2},
    {"bits/LF px", "bits_per_light_field_pixel", "/events/bits_per_light_field_pixel", 2}};

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
  const auto add = [&](const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
  };
  add("gain", row.gain);
  add("black", row.black);
  add("fitted_gain", row.fitted_gain);
  add("fitted_black", row.fitted_black);
  if (row.disparity) json["disparity"] = to_json(*row.disparity);
  return json;
}

report::Table quality_table(std::span<const EvalRow> rows) {
  report::Table table{"", {{"method"}, {"scene"}}, {}};
  std::vector<Json> values;
  for (const EvalRow& row : rows) {
    values.push_back(to_json(row));
    table.rows.push_back({report::text_cell(row.method), report::text_cell(row.scene)});
  }
  for (const QualityColumn& column : kColumns) {
    const Json::json_pointer place(column.place);
    if (std::ranges::none_of(values, [&](const Json& row) { return row.contains(place); })) continue;
    table.columns.push_back({column.name, true, false, column.key});
    for (size_t i = 0; i < values.size(); ++i) {
      const Json value = values[i].contains(place) ? values[i].at(place) : Json(NAN);
      table.rows[i].push_back(value.is_null() ? report::Cell{"inf", nullptr}
                                              : report::number_cell(value.get<double>(), column.decimals));
    }
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
