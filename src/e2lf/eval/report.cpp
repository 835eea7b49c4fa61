// SPDX-License-Identifier: MIT
#include "e2lf/eval/report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

namespace e2lf::eval {
namespace {

using Cells = std::vector<std::string>;

std::string fixed(double value, int decimals) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(decimals) << value;
  return std::move(out).str();
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

void add_metrics(const Metrics& metrics, Json& json) {
  json["psnr_db"] = number(metrics.psnr_db);
  json["ssim_uniform7"] = number(metrics.ssim_uniform7);
  json["ssim_gaussian"] = number(metrics.ssim_gaussian);
}

/// A line of cells: text columns to the left, the numbers after them to the right.
std::string aligned_line(const Cells& cells, const std::vector<size_t>& widths, size_t text_columns) {
  std::ostringstream out;
  for (size_t column = 0; column < cells.size(); ++column) {
    if (column > 0) out << "  ";
    out << (column < text_columns ? std::left : std::right) << std::setw(static_cast<int>(widths[column]))
        << cells[column];
  }
  std::string line = std::move(out).str();
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string aligned(const std::vector<Cells>& lines, size_t text_columns) {
  std::vector<size_t> widths(lines.front().size());
  for (const Cells& line : lines) {
    for (size_t column = 0; column < line.size(); ++column) {
      widths[column] = std::max(widths[column], line[column].size());
    }
  }
  std::string text;
  for (const Cells& line : lines) text += aligned_line(line, widths, text_columns);
  return text;
}

Cells quality_cells(const EvalRow& row) {
  const Metrics& mean = row.quality.mean;
  return {row.method,
          row.scene,
          fixed(mean.psnr_db, 2),
          fixed(mean.ssim_uniform7, 4),
          fixed(mean.ssim_gaussian, 4),
          fixed(row.quality.epi.relative, 3)};
}

/// The cells for events: as many as the heading has, empty without events.
Cells event_cells(const EvalRow& row) {
  if (!row.events) return {"", "", ""};
  return {fixed(row.events->total_events_per_pixel, 3), fixed(row.events->min_measurement_ms, 2),
          fixed(row.events->bits_per_light_field_pixel, 2)};
}

void append(Cells& cells, const Cells& more) {
  cells.insert(cells.end(), more.begin(), more.end());
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_line(const Cells& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    line += csv_cell(cell);
  }
  return line + "\r\n";
}

std::string latex_text(const std::string& text) {
  std::string escaped;
  for (char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

Json to_json(const LightFieldMetrics& quality) {
  Json json;
  add_metrics(quality.mean, json);
  json["epi_rms_error"] = number(quality.epi.rms);
  json["epi_relative_error"] = number(quality.epi.relative);
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

Json to_json(const EvalRow& row) {
  Json json{{"method", row.method}, {"scene", row.scene}};
  json.update(to_json(row.quality));
  if (row.events) json["events"] = to_json(*row.events);
  return json;
}

std::string table_text(std::span<const EvalRow> rows) {
  const bool with_events = std::any_of(rows.begin(), rows.end(), [](const EvalRow& row) { return !!row.events; });
  std::vector<Cells> lines{{"method", "scene", "PSNR dB", "SSIM 7x7", "SSIM Gauss", "EPI error"}};
  if (with_events) append(lines.front(), {"events/px", "min ms", "bits/LF px"});
  for (const EvalRow& row : rows) {
    lines.push_back(quality_cells(row));
    if (with_events) append(lines.back(), event_cells(row));
  }
  return aligned(lines, 2);
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

std::string csv_text(std::span<const EvalRow> rows) {
  std::string text = csv_line({"method", "scene", "psnr_db", "ssim_uniform7", "ssim_gaussian", "epi_relative_error",
                               "events_per_pixel", "min_measurement_ms", "bits_per_light_field_pixel"});
  for (const EvalRow& row : rows) {
    Cells cells = quality_cells(row);
    append(cells, event_cells(row));
    text += csv_line(cells);
  }
  return text;
}

std::string latex_row(const std::string& method, std::span<const EvalRow> scenes) {
  std::string text = latex_text(method);
  for (const EvalRow& row : scenes) {
    text += " & " + fixed(row.quality.mean.psnr_db, 2) + "/" + fixed(row.quality.mean.ssim_uniform7, 4);
  }
  return text + " \\\\";
}

}  // namespace e2lf::eval
