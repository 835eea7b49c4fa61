// SPDX-License-Identifier: MIT
#include "e2lf/compare/result_page.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/epi.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/report/axis.h"
#include "e2lf/report/chart.h"
#include "e2lf/report/page.h"

namespace e2lf::compare {
namespace {

std::string counted(size_t count, const char* what) {
  return cat(count, " ", what, count == 1 ? "" : "s");
}

/// Returns the result of a method on a scene with the first seed, or null if there is none.
const Json* first_result(const Plan& plan, const Results& results, size_t method, size_t scene, size_t sensor,
                         std::string* key = nullptr) {
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    const Job& job = plan.jobs[i];
    if (job.method != method || job.scene != scene || job.sensor != sensor) continue;
    if (key != nullptr) *key = job.key;
    return results[i] ? &*results[i] : nullptr;
  }
  return nullptr;
}

void add_bars(const Plan& plan, const Results& results, size_t sensor, report::Page& page) {
  for (const Metric& metric : metrics_of(plan.metrics)) {
    if (!metric.is_quality) continue;
    report::BarChart chart;
    chart.y_label = cat(metric.heading, std::string(metric.name) == "psnr_db" ? ", dB" : "");
    chart.from_zero = std::string(metric.name) != "psnr_db";
    chart.decimals = metric.decimals;
    for (const Scene& scene : plan.scenes) chart.groups.push_back(scene.name);
    for (size_t method = 0; method < plan.methods.size(); ++method) {
      report::BarChart::Series series{plan.methods[method].config.name, {}};
      for (size_t scene = 0; scene < plan.scenes.size(); ++scene) {
        series.values.push_back(scene_mean(plan, results, {method, scene, sensor, 0, {}, {}}, metric.name));
      }
      chart.series.push_back(std::move(series));
    }
    page.drawing(report::chart_svg(chart));
  }
}

/// Returns the mean PSNR of each view over the results, or nothing if none has one.
std::vector<double> view_means(const Plan& plan, const Results& results, size_t method, size_t sensor) {
  std::vector<double> sums;
  size_t count = 0;
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    if (!results[i] || plan.jobs[i].method != method || plan.jobs[i].sensor != sensor) continue;
    const Json views = results[i]->value("views_psnr_db", Json::array());
    if (!views.is_array() || (count > 0 && views.size() != sums.size())) continue;
    sums.resize(views.size());
    for (size_t v = 0; v < sums.size(); ++v) sums[v] += views[v].is_number() ? views[v].get<double>() : NAN;
    ++count;
  }
  for (double& sum : sums) sum /= static_cast<double>(count);
  return sums;
}

void add_views(const Plan& plan, const Results& results, size_t sensor, report::Page& page) {
  std::vector<std::vector<double>> grids;
  double low = INFINITY, high = -INFINITY;
  for (size_t method = 0; method < plan.methods.size(); ++method) {
    grids.push_back(view_means(plan, results, method, sensor));
    for (const double value : grids.back()) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (low > high) return;
  page.heading("PSNR of the views, dB", 3).paragraph("Means over all scenes, in the order of the aperture.");
  page.begin_row();
  for (size_t method = 0; method < plan.methods.size(); ++method) {
    if (grids[method].empty()) continue;
    const auto columns = static_cast<size_t>(std::lround(std::sqrt(static_cast<double>(grids[method].size()))));
    page.drawing(report::grid_svg({columns, grids[method], low, high, 1, 36}), plan.methods[method].config.name);
  }
  page.end_row();
}

/// Returns the cells of a pattern in the form of codes_to_json(): rows of 0 and 1, or of numbers.
std::vector<double> cells_of(const Json& pattern, size_t& columns) {
  std::vector<double> cells;
  for (const Json& row : pattern) {
    columns = row.is_string() ? row.get<std::string>().size() : row.size();
    if (row.is_string()) {
      for (const char c : row.get<std::string>()) cells.push_back(c == '1' ? 1 : 0);
    } else {
      for (const Json& value : row) cells.push_back(value.get<double>());
    }
  }
  return cells;
}

/// Returns the names of the methods with the same patterns, or "" if an earlier method has them as well.
std::string names_with_patterns_of(const Plan& plan, size_t method) {
  std::vector<std::string> names;
  for (size_t i = 0; i < plan.methods.size(); ++i) {
    if (plan.methods[i].codes != plan.methods[method].codes) continue;
    if (i < method) return {};
    names.push_back(plan.methods[i].config.name);
  }
  return join(names, "; ");
}

/// Adds the patterns of the methods, each with the events per pixel of the change to it.
void add_patterns(const Plan& plan, const Results& results, size_t sensor, report::Page& page) {
  page.heading("Patterns", 3)
      .paragraph("Under each pattern: events per pixel of the change to it, mean over all scenes.");
  for (size_t method = 0; method < plan.methods.size(); ++method) {
    const std::string names = names_with_patterns_of(plan, method);
    if (names.empty()) continue;
    std::vector<double> events;
    const Json* shown = nullptr;
    size_t count = 0;
    for (size_t scene = 0; scene < plan.scenes.size(); ++scene) {
      const Json* result = first_result(plan, results, method, scene, sensor);
      if (result == nullptr) continue;
      shown = result;
      const auto each = result->value("events_per_transition", std::vector<double>());
      events.resize(std::max(events.size(), each.size()));
      for (size_t k = 0; k < each.size(); ++k) events[k] += each[k];
      ++count;
    }
    if (shown == nullptr || is_scan(plan.methods[method])) continue;
    page.heading(names, 4).begin_row();
    size_t number = 0;
    for (const Json& pattern : shown->at("patterns")) {
      size_t columns = 1;
      const std::vector<double> cells = cells_of(pattern, columns);
      const std::string caption = number == 0 || number > events.size()
                                      ? ""
                                      : report::tick_text(events[number - 1] / static_cast<double>(count), 3);
      page.drawing(report::grid_svg({columns, cells}), cat("a", number + 1, caption.empty() ? "" : ": ", caption));
      ++number;
    }
    page.end_row();
  }
}

void add_pictures(const Plan& plan, const Results& results, const ResultStore& store, size_t sensor,
                  report::Page& page) {
  page.heading("Pictures", 3)
      .paragraph(
          "The upper left view and its enlarged middle, with the EPI of the middle row below. Beside it is the error: "
          "black is none, white is 0.2 and more. Below is the disparity: bright is near, dark is far.");
  for (size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    const std::vector<uint8_t> truth = store.picture(truth_key(plan.scenes[scene]));
    if (truth.empty()) continue;
    std::vector<std::vector<uint8_t>> kept = {truth};
    std::vector<std::string> captions = {"truth"};
    for (size_t method = 0; method < plan.methods.size(); ++method) {
      std::string key;
      const Json* result = first_result(plan, results, method, scene, sensor, &key);
      std::vector<uint8_t> png = store.picture(key);
      if (result == nullptr || png.empty()) continue;
      const Json psnr = result->value("psnr_db", Json());
      kept.push_back(std::move(png));
      captions.push_back(cat(plan.methods[method].config.name,
                             psnr.is_number() ? cat(", ", report::tick_text(psnr.get<double>(), 2), " dB") : ""));
    }
    std::vector<report::Picture> pictures;
    for (size_t i = 0; i < kept.size(); ++i) pictures.push_back({kept[i], captions[i]});
    page.heading(cat(plan.scenes[scene].group.name, ": ", plan.scenes[scene].name), 4).pictures(pictures);
  }
}

}  // namespace

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
    page.heading("Scenes", 3);
    add_bars(plan, results, sensor, page);
    add_views(plan, results, sensor, page);
    add_patterns(plan, results, sensor, page);
    if (plan.pictures) add_pictures(plan, results, store, sensor, page);
  }
  return page.html();
}

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

constexpr size_t kMostWidth = 320, kGap = 4, kRowsPerView = 5;
constexpr float kWhiteError = 0.2F;

Image fitted(const Image& image) {
  if (image.width <= kMostWidth) return image;
  return lightfield::shrink(image, kMostWidth, std::max<size_t>(1, image.height * kMostWidth / image.width));
}

/// Copies an image onto the canvas, converting grey to colour if the canvas has colour.
void paste(const Image& image, size_t top, size_t left, Image& canvas) {
  for (size_t y = 0; y < image.height; ++y) {
    for (size_t x = 0; x < image.width; ++x) {
      const float* from = image.pixels.data() + (y * image.width + x) * image.channels;
      float* to = canvas.pixels.data() + ((top + y) * canvas.width + left + x) * canvas.channels;
      for (size_t c = 0; c < canvas.channels; ++c) to[c] = from[std::min(c, image.channels - 1)];
    }
  }
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
