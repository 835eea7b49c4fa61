// SPDX-License-Identifier: MIT
#include "e2lf/eval/report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

#include "e2lf/files/options.h"

namespace e2lf::eval {
namespace {

std::string fixed(double value, int decimals) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(decimals) << value;
  return std::move(out).str();
}

void add_metrics(const Metrics& metrics, Json& json) {
  json["psnr_db"] = finite_or_null(metrics.psnr_db);
  json["ssim_uniform7"] = finite_or_null(metrics.ssim_uniform7);
  json["ssim_gaussian"] = finite_or_null(metrics.ssim_gaussian);
}

report::Cell quality_cell(double value, int decimals) {
  return std::isinf(value) ? report::Cell{"inf", nullptr} : report::number_cell(value, decimals);
}

/// The columns of gains and black levels.
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
  return {{"events_per_pixel", events.events_per_pixel},
          {"total_events_per_pixel", events.total_events_per_pixel},
          {"min_measurement_ms", events.min_measurement_ms},
          {"bits_per_sensor_pixel", events.bits_per_sensor_pixel},
          {"bits_per_light_field_pixel", events.bits_per_light_field_pixel},
          {"events_per_light_field_pixel", events.events_per_light_field_pixel}};
}

Json to_json(const depth::DisparityError& error) {
  Json json{{"bad_07_percent", error.bad_07_percent},
            {"bad_20_percent", error.bad_20_percent},
            {"mean_absolute_px", error.mean_absolute_px},
            {"slope", error.slope},
            {"num_pixels", error.num_pixels},
            {"most_certain", Json::array()}};
  for (const depth::ErrorPart& part : error.most_certain) {
    json["most_certain"].push_back({{"pixels_percent", part.pixels_percent},
                                    {"bad_20_percent", part.bad_20_percent},
                                    {"mean_absolute_px", part.mean_absolute_px}});
  }
  return json;
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
  const bool with_events = has(&EvalRow::events), with_disparity = has(&EvalRow::disparity);
  report::Table table;
  const auto add_column = [&](const char* name, const char* key) {
    table.columns.push_back({name, table.columns.size() > 1, false, key});
  };
  add_column("method", "method");
  add_column("scene", "scene");
  add_column("PSNR dB", "psnr_db");
  add_column("SSIM 7x7", "ssim_uniform7");
  add_column("SSIM Gauss", "ssim_gaussian");
  add_column("EPI error", "epi_relative_error");
  if (with_disparity) {
    add_column("> 0.07 px, %", "bad_07_percent");
    add_column("> 0.2 px, %", "bad_20_percent");
    add_column("off px", "mean_absolute_px");
    add_column("slope", "slope");
  }
  for (const auto& [name, key, member] : kTones) {
    if (has(member)) add_column(name, key);
  }
  if (with_events) {
    add_column("events/px", "events_per_pixel");
    add_column("min ms", "min_measurement_ms");
    add_column("bits/LF px", "bits_per_light_field_pixel");
  }
  for (const EvalRow& row : rows) {
    const Metrics& mean = row.quality.mean;
    table.rows.push_back({report::text_cell(row.method), report::text_cell(row.scene), quality_cell(mean.psnr_db, 2),
                          quality_cell(mean.ssim_uniform7, 4), quality_cell(mean.ssim_gaussian, 4),
                          quality_cell(row.quality.epi.relative, 3)});
    const auto add_error = [&](double depth::DisparityError::*member, int decimals) {
      table.rows.back().push_back(row.disparity ? report::number_cell((*row.disparity).*member, decimals)
                                                : report::Cell());
    };
    if (with_disparity) {
      add_error(&depth::DisparityError::bad_07_percent, 1);
      add_error(&depth::DisparityError::bad_20_percent, 1);
      add_error(&depth::DisparityError::mean_absolute_px, 3);
      add_error(&depth::DisparityError::slope, 2);
    }
    for (const auto& [name, key, member] : kTones) {
      if (!has(member)) continue;
      table.rows.back().push_back(row.*member ? report::number_cell(*(row.*member), 3) : report::Cell());
    }
    if (!with_events) continue;
    const auto add = [&](double EventStatistics::*member, int decimals) {
      table.rows.back().push_back(row.events ? report::number_cell((*row.events).*member, decimals) : report::Cell());
    };
    add(&EventStatistics::total_events_per_pixel, 3);
    add(&EventStatistics::min_measurement_ms, 2);
    add(&EventStatistics::bits_per_light_field_pixel, 2);
  }
  return table;
}

std::string view_grid_text(const LightFieldMetrics& quality) {
  std::string text;
  for (size_t i = 0; i < quality.views.size(); ++i) {
    const bool new_line = i > 0 && quality.views[i].view_y != quality.views[i - 1].view_y;
    text += new_line ? "\n" : (i > 0 ? " " : "");
    text += fixed(quality.views[i].metrics.psnr_db, 2);
  }
  return text + "\n";
}

}  // namespace e2lf::eval
