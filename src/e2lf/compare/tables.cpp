// SPDX-License-Identifier: MIT
#include "e2lf/compare/tables.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/report/axis.h"

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

std::vector<Metric> metrics_of(const std::vector<std::string>& names) {
  std::vector<Metric> metrics;
  for (const Metric& metric : all_metrics()) {
    if (std::find(names.begin(), names.end(), metric.name) != names.end()) metrics.push_back(metric);
  }
  return metrics;
}

namespace {

using report::Cell;
using report::Table;

/// Returns the metrics of a plan that are of one kind.
std::vector<Metric> metrics_of_kind(const Plan& plan, bool is_quality) {
  std::vector<Metric> metrics = metrics_of(plan.metrics);
  std::erase_if(metrics, [&](const Metric& metric) { return metric.is_quality != is_quality; });
  return metrics;
}

std::optional<double> figure(const std::optional<Json>& result, const char* metric) {
  if (!result || !result->contains(metric) || !result->at(metric).is_number()) return std::nullopt;
  return result->at(metric).get<double>();
}

/// Computes a mean, which is missing if any of its values is missing.
class Mean {
 public:
  void add(const std::optional<double>& value) {
    is_whole_ = is_whole_ && value;
    sum_ += value.value_or(0.0);
    ++count_;
  }
  [[nodiscard]] std::optional<double> value() const {
    if (!is_whole_ || count_ == 0) return std::nullopt;
    return sum_ / static_cast<double>(count_);
  }

 private:
  double sum_ = 0;
  size_t count_ = 0;
  bool is_whole_ = true;
};

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

}  // namespace

std::optional<double> scene_mean(const Plan& plan, const Results& results, const Job& of, const char* metric) {
  Mean mean;
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    const Job& job = plan.jobs[i];
    if (job.method == of.method && job.scene == of.scene && job.sensor == of.sensor) {
      mean.add(figure(results[i], metric));
    }
  }
  return mean.value();
}

std::optional<double> group_mean(const Plan& plan, const Results& results, size_t method, size_t sensor,
                                 const std::string& group, const char* metric) {
  Mean mean;
  for (size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    if (plan.scenes[scene].group.name != group) continue;
    mean.add(scene_mean(plan, results, {method, scene, sensor, 0, {}, {}}, metric));
  }
  return mean.value();
}

std::optional<double> mean_of_groups(const Plan& plan, const Results& results, size_t method, size_t sensor,
                                     const char* metric) {
  Mean mean;
  for (const std::string& group : plan.groups) mean.add(group_mean(plan, results, method, sensor, group, metric));
  return mean.value();
}

Table quality_table(const Plan& plan, const Results& results, size_t sensor) {
  const std::vector<Metric> metrics = metrics_of_kind(plan, /*is_quality=*/true);
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
  const std::vector<Metric> metrics = metrics_of_kind(plan, /*is_quality=*/false);
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

Table result_table(const Plan& plan, const Results& results) {
  std::vector<Metric> metrics = metrics_of(plan.metrics);
  std::erase_if(metrics, [](const Metric& metric) { return !metric.is_repeatable; });
  Table table;
  table.columns = {{"method"}, {"N", true}, {"sensor"}, {"group"}, {"scene"}, {"seed", true}};
  for (const Metric& metric : metrics) table.columns.push_back({metric.name, true});
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    if (!results[i]) continue;
    const Job& job = plan.jobs[i];
    const Scene& scene = plan.scenes[job.scene];
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

}  // namespace e2lf::compare
