// SPDX-License-Identifier: MIT
#include "e2lf/compare/tables.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_picture.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/report/chart.h"
#include "e2lf/report/page.h"

namespace e2lf::compare {

std::span<const Metric> all_metrics() {
  static constexpr Metric kMetrics[] = {
      {"psnr_db", "PSNR", 2, false, true, true},
      {"ssim", "SSIM", 4, false, true, true},
      {"ssim_gaussian", "SSIM (Gauss)", 4, false, true, true},
      {"epi_error", "EPI error", 3, true, true, true},
      {"bad_07_percent", "disparity > 0.07 px, %", 1, true, true, true},
      {"bad_20_percent", "disparity > 0.2 px, %", 1, true, true, true},
      {"disparity_error_px", "disparity error, px", 3, true, true, true},
      {"disparity_slope", "disparity slope", 2, false, true, true},
      {"events_per_pixel", "events/px", 3, true, false, true},
      {"bits_per_pixel", "bits per LF px", 2, true, false, true},
      {"measurement_ms", "measured ms", 1, true, false, true},
      {"cycle_ms", "cycle ms", 1, true, false, true},
      {"reconstruct_s", "reconstruction s", 2, true, false, false},
  };
  return kMetrics;
}

namespace {

using report::Cell;
using report::Table;

/// Returns the metrics of a plan for which a member has this value, in the order of all_metrics().
std::vector<Metric> metrics_of(const Plan& plan, bool Metric::*member, bool value) {
  std::vector<Metric> metrics;
  for (const Metric& metric : all_metrics()) {
    const bool is_wanted = std::find(plan.metrics.begin(), plan.metrics.end(), metric.name) != plan.metrics.end();
    if (is_wanted && metric.*member == value) metrics.push_back(metric);
  }
  return metrics;
}

std::optional<double> figure(const std::optional<Json>& result, const char* metric) {
  if (!result || !result->contains(metric) || !result->at(metric).is_number()) return std::nullopt;
  return result->at(metric).get<double>();
}

/// Returns the mean, which is missing if any of the values is missing.
std::optional<double> mean_of(const std::vector<std::optional<double>>& values) {
  double sum = 0;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  return values.empty() ? std::nullopt : std::optional(sum / static_cast<double>(values.size()));
}

/// Makes a cell "28.40/0.8330" with its values, or an empty one if a value is missing.
template <typename ValueOf>
Cell quality_cell(const std::vector<Metric>& metrics, const ValueOf& value_of) {
  Cell cell;
  cell.value = Json::object();
  for (const Metric& metric : metrics) {
    const std::optional<double> value = value_of(metric.name);
    if (!value) return {};
    cell.text += (cell.text.empty() ? "" : "/") + report::tick_text(*value, metric.decimals);
    cell.value[metric.name] = *value;
  }
  return cell;
}

std::string headings_of(const std::vector<Metric>& metrics) {
  std::vector<std::string> names;
  for (const Metric& metric : metrics) names.emplace_back(cat(metric.heading, metric.name[0] == 'p' ? " in dB" : ""));
  return join(names, " / ");
}

size_t num_patterns(const Plan& plan, size_t method) {
  return plan.methods[method].codes.num_patterns;
}

std::string sensor_text(const Plan& plan, size_t sensor) {
  return cat("Sensor: ", plan.sensors[sensor].config.name, ".");
}

std::optional<double> scene_mean(const Plan& plan, const Results& results, size_t method, size_t scene, size_t sensor,
                                 const char* metric) {
  std::vector<std::optional<double>> values;
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    const Job& job = plan.jobs[i];
    if (job.method == method && job.scene == scene && job.sensor == sensor) {
      values.push_back(figure(results[i], metric));
    }
  }
  return mean_of(values);
}

std::optional<double> group_mean(const Plan& plan, const Results& results, size_t method, size_t sensor,
                                 const std::string& group, const char* metric) {
  std::vector<std::optional<double>> values;
  for (size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    if (plan.scenes[scene].group.name != group) continue;
    values.push_back(scene_mean(plan, results, method, scene, sensor, metric));
  }
  return mean_of(values);
}

std::optional<double> mean_of_groups(const Plan& plan, const Results& results, size_t method, size_t sensor,
                                     const char* metric) {
  std::vector<std::optional<double>> values;
  for (const std::string& group : plan.groups)
    values.push_back(group_mean(plan, results, method, sensor, group, metric));
  return mean_of(values);
}

Table result_table(const Plan& plan, const Results& results) {
  const std::vector<Metric> metrics = metrics_of(plan, &Metric::is_repeatable, true);
  Table table;
  table.columns = {{"method"}, {"N", true}, {"sensor"}, {"group"}, {"scene"}, {"seed", true}};
  for (const Metric& metric : metrics) table.columns.push_back({metric.name, true});
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    if (!results[i]) continue;
    const Job& job = plan.jobs[i];
    const ComparedScene& scene = plan.scenes[job.scene];
    std::vector<Cell> row = {report::text_cell(plan.methods[job.method].config.name),
                             {std::to_string(num_patterns(plan, job.method)), num_patterns(plan, job.method)},
                             report::text_cell(plan.sensors[job.sensor].config.name),
                             report::text_cell(scene.group.name),
                             report::text_cell(scene.name),
                             {std::to_string(job.seed), job.seed}};
    for (const Metric& metric : metrics)
      row.push_back(report::number_cell(figure(results[i], metric.name), metric.decimals));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Table quality_table(const Plan& plan, const Results& results, size_t sensor) {
  const std::vector<Metric> metrics = metrics_of(plan, &Metric::is_quality, true);
  Table table;
  table.caption = cat(headings_of(metrics), ". ", sensor_text(plan, sensor));
  table.columns = {{"method"}, {"N", true}};
  for (const std::string& group : plan.groups) table.columns.push_back({group, true, table.columns.size() == 2});
  const bool has_mean = plan.groups.size() > 1;
  if (has_mean) table.columns.push_back({"mean", true, true});
  for (size_t method = 0; method < plan.methods.size(); ++method) {
    const auto n = static_cast<double>(num_patterns(plan, method));
    std::vector<Cell> row = {report::text_cell(plan.methods[method].config.name), report::number_cell(n, 0)};
    for (const std::string& group : plan.groups) {
      row.push_back(quality_cell(
          metrics, [&](const char* metric) { return group_mean(plan, results, method, sensor, group, metric); }));
    }
    if (has_mean) {
      row.push_back(quality_cell(
          metrics, [&](const char* metric) { return mean_of_groups(plan, results, method, sensor, metric); }));
    }
    table.rows.push_back(std::move(row));
  }
  for (const std::string& name : plan.left_out) {
    std::vector<Cell> row(table.columns.size());
    row.front() = report::text_cell(name + " (weights not available)");
    table.rows.push_back(std::move(row));
  }
  const bool is_least = !metrics.empty() && metrics.front().is_least_best;
  for (size_t column = 2; column < table.columns.size(); ++column) report::mark_best(table, column, is_least);
  return table;
}

Table cost_table(const Plan& plan, const Results& results, size_t sensor) {
  const std::vector<Metric> metrics = metrics_of(plan, &Metric::is_quality, false);
  Table table;
  table.caption = cat("Cost of a light field. ", sensor_text(plan, sensor));
  table.columns = {{"method"}};
  for (const Metric& metric : metrics) table.columns.push_back({metric.heading, true});
  for (size_t method = 0; method < plan.methods.size(); ++method) {
    std::vector<Cell> row = {report::text_cell(plan.methods[method].config.name)};
    for (const Metric& metric : metrics) {
      row.push_back(report::number_cell(mean_of_groups(plan, results, method, sensor, metric.name), metric.decimals));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Json all_json(const Plan& plan, const Results& results) {
  Json json = {{"name", plan.name}, {"sensors", Json::array()}};
  for (size_t sensor = 0; sensor < plan.sensors.size(); ++sensor) {
    json["sensors"].push_back({{"sensor", plan.sensors[sensor].config.name},
                               {"quality", report::table_json(quality_table(plan, results, sensor))["rows"]},
                               {"cost", report::table_json(cost_table(plan, results, sensor))["rows"]}});
  }
  json["results"] = report::table_json(result_table(plan, results))["rows"];
  return json;
}

namespace {

void add_pictures(const Plan& plan, const Results& results, const ResultStore& store, size_t sensor,
                  report::Page& page) {
  page.heading("Pictures", 3)
      .paragraph(
          "The upper left view and its enlarged middle, with the EPI of the middle row below. Beside it is the error: "
          "black is none, white is 0.2 and more. Below is the disparity: bright is near, dark is far.");
  for (size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    const std::vector<uint8_t> truth = store.picture(truth_key(plan.scenes[scene]));
    if (truth.empty()) continue;
    std::vector<report::Picture> pictures = {{truth, "truth"}};
    for (size_t method = 0; method < plan.methods.size(); ++method) {
      const auto job = std::ranges::find_if(plan.jobs, [&](const Job& each) {  // with the first seed
        return each.method == method && each.scene == scene && each.sensor == sensor;
      });
      const auto number = static_cast<size_t>(job - plan.jobs.begin());
      if (job == plan.jobs.end() || !results[number]) continue;
      std::vector<uint8_t> png = store.picture(job->key);
      if (png.empty()) continue;
      const Json psnr = results[number]->value("psnr_db", Json());
      pictures.push_back(
          {std::move(png), cat(plan.methods[method].config.name,
                               psnr.is_number() ? cat(", ", report::tick_text(psnr.get<double>(), 2), " dB") : "")});
    }
    page.heading(cat(plan.scenes[scene].group.name, ": ", plan.scenes[scene].name), 4).pictures(pictures);
  }
}

std::string result_page(const Plan& plan, const Results& results, const ResultStore& store,
                        const std::string& command) {
  report::Page page(plan.name);
  const auto there = static_cast<size_t>(
      std::count_if(results.begin(), results.end(), [](const auto& result) { return result.has_value(); }));
  page.paragraph(cat(counted(plan.methods.size(), "method"), ", ", counted(plan.scenes.size(), "scene"), " in ",
                     counted(plan.groups.size(), "group"), ", ", counted(plan.sensors.size(), "sensor"), "; ", there,
                     " of ", counted(results.size(), "result"),
                     " exist. The mean is that of the groups. The best value of each column is marked."));
  page.code(command);
  for (size_t sensor = 0; sensor < plan.sensors.size(); ++sensor) {
    page.heading(cat("Sensor ", plan.sensors[sensor].config.name));
    page.table(quality_table(plan, results, sensor));
    const report::Table cost = cost_table(plan, results, sensor);
    if (cost.columns.size() > 1) page.table(cost);
    if (plan.pictures) add_pictures(plan, results, store, sensor, page);
  }
  return page.html();
}

}  // namespace

Result<void> write_tables(const std::filesystem::path& folder, const Plan& plan, const Results& results,
                          const ResultStore& store, const std::string& command) {
  std::string latex;
  for (size_t sensor = 0; sensor < plan.sensors.size(); ++sensor) {
    latex += report::table_latex(quality_table(plan, results, sensor));
  }
  E2LF_RETURN_IF_ERROR(write_file(folder / "table.csv", report::table_csv(result_table(plan, results))));
  E2LF_RETURN_IF_ERROR(write_file(folder / "table.json", json_text(all_json(plan, results))));
  E2LF_RETURN_IF_ERROR(write_file(folder / "table.tex", latex));
  return write_file(folder / "index.html", result_page(plan, results, store, command));
}

namespace {

using lightfield::enlarged;
using lightfield::Image;
using lightfield::LightField;
using lightfield::paste;

constexpr size_t kMostWidth = 320, kGap = 4, kRowsPerView = 5;
constexpr float kWhiteError = 0.2F;

Image fitted(const Image& image) {
  if (image.width <= kMostWidth) return image;
  return lightfield::shrink(image, kMostWidth, std::max<size_t>(1, image.height * kMostWidth / image.width));
}

/// Returns the error of the first view, averaged over its colours.
Image error_image(const Image& view, const Image& truth) {
  Image error(view.width, view.height, 1);
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    const float difference = std::abs(std::clamp(view.pixels[i], 0.0F, 1.0F) - truth.pixels[i]);
    error.pixels[i / view.channels] += difference / (kWhiteError * static_cast<float>(view.channels));
  }
  return error;
}

/// Returns the middle of a picture, enlarged and with a white frame. Its sides are at most a third of those of the
/// view.
Image inset_of(const Image& view, const Image& shown) {
  const size_t times = 3;
  const size_t side = std::max<size_t>(1, std::min(shown.width, shown.height) / 3 / times);
  Image part(side, side, view.channels);
  for (size_t y = 0; y < side; ++y) {
    const size_t from = ((view.height - side) / 2 + y) * view.width + (view.width - side) / 2;
    std::copy_n(view.pixels.data() + from * view.channels, side * view.channels,
                part.pixels.data() + y * side * view.channels);
  }
  Image framed(side * times + 2, side * times + 2, view.channels);
  std::fill(framed.pixels.begin(), framed.pixels.end(), 1.0F);
  paste(enlarged(part, times, times), 1, 1, framed);
  return framed;
}

}  // namespace

Image look(const LightField& field, const LightField* truth, const Image& disparity, const Image& true_disparity) {
  E2LF_REQUIRE(truth == nullptr || truth->shape() == field.shape(), "a light field is compared with one of its shape");
  const Image view = lightfield::view_image(field, 0, 0);
  const Image shown = fitted(view);
  const Image epi = lightfield::horizontal_epi(field, 0, field.shape().height / 2);
  const Image strip =
      enlarged(epi.width > shown.width ? lightfield::shrink(epi, shown.width, epi.height) : epi, kRowsPerView, 1);
  const size_t columns = truth == nullptr ? 1 : 2;
  const bool has_disparity = !disparity.pixels.empty();
  const size_t height = shown.height + kGap + strip.height;
  Image canvas(columns * (shown.width + kGap) - kGap, height + (has_disparity ? kGap + shown.height : 0),
               has_disparity ? 3 : field.shape().channels);
  std::fill(canvas.pixels.begin(), canvas.pixels.end(), 0.5F);
  paste(shown, 0, 0, canvas);
  const Image inset = inset_of(view, shown);
  if (inset.width <= shown.width && inset.height <= shown.height) {
    paste(inset, shown.height - inset.height, shown.width - inset.width, canvas);
  }
  paste(strip, shown.height + kGap, 0, canvas);
  if (has_disparity) {
    const Image& shown_fully = true_disparity.pixels.empty() ? disparity : true_disparity;
    paste(fitted(depth::colour_picture(disparity, depth::shown_range(shown_fully))), height + kGap, 0, canvas);
  }
  if (truth == nullptr) return canvas;
  paste(fitted(error_image(view, lightfield::view_image(*truth, 0, 0))), 0, shown.width + kGap, canvas);
  return canvas;
}

}  // namespace e2lf::compare
