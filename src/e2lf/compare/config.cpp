// SPDX-License-Identifier: MIT
#include "e2lf/compare/config.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "e2lf/base/text.h"
#include "e2lf/compare/tables.h"

namespace e2lf::compare {
namespace {

// The keys of a configuration, which docs/compare.md describes; see files/options.h.

template <typename AnyConfig, typename Visitor>
void visit_config(AnyConfig& config, Visitor& visit) {
  visit("name", config.name);
  visit.list("methods", config.methods, [](auto& method, auto& inner) {
    E2LF_VISIT(method, inner, name, algorithm, model, codes, camera, command, passes, gain, fit_gain, precision,
               optional);
  });
  visit.list("scenes", config.scenes, [](auto& group, auto& inner) {
    E2LF_VISIT(group, inner, name, scenes, stand_in, width, height, step, reverse_rows, optional);
  });
  visit.list("sensors", config.sensors, [](auto& sensor, auto& inner) {
    E2LF_VISIT(sensor, inner, name, camera, tau, sigma_w, sigma_z, sigma_i, gain, residue, cycles, fit_gain);
  });
  E2LF_VISIT(config, visit, seeds, metrics, pictures);
}

Error invalid(const std::string& message, const std::string& location) {
  return fail(ErrorCode::kInvalidValue, location, message);
}

template <typename Item>
Result<void> check_names(const std::vector<Item>& items, const std::string& location) {
  if (items.empty()) return invalid("the list is empty; add at least one entry", location);
  std::set<std::string> names;
  for (size_t i = 0; i < items.size(); ++i) {
    const std::string place = cat(location, "[", i, "].name");
    if (items[i].name.empty()) return invalid("the entry has no name; add one", place);
    if (!names.insert(items[i].name).second) {
      return invalid(cat("two entries are named \"", items[i].name, "\"; rename one of them"), place);
    }
  }
  return {};
}

Result<void> check_word(const std::string& word, const std::vector<std::string>& known, const std::string& location) {
  if (std::find(known.begin(), known.end(), word) != known.end()) return {};
  return invalid(cat("\"", word, "\" is not a known value; ", suggestion(word, known)), location);
}

Result<void> check_positive(float value, const std::string& location) {
  if (std::isfinite(value) && value > 0) return {};
  return invalid(cat(value, " is out of range; give a positive number"), location);
}

Result<void> check_count(size_t value, const std::string& location) {
  if (value >= 1 && value <= 64) return {};
  return invalid(cat(value, " is out of range; give 1 to 64"), location);
}

Result<void> check_method(const MethodConfig& method, const std::string& location) {
  const std::vector<std::string> algorithms(std::begin(kAlgorithms), std::end(kAlgorithms));
  E2LF_RETURN_IF_ERROR(check_word(method.algorithm, algorithms, location + ".algorithm"));
  E2LF_RETURN_IF_ERROR(check_word(method.precision, {"float32", "bfloat16", "auto"}, location + ".precision"));
  E2LF_RETURN_IF_ERROR(check_positive(method.gain, location + ".gain"));
  E2LF_RETURN_IF_ERROR(check_count(method.passes, location + ".passes"));
  const bool is_network = method.algorithm == "network", is_video = method.algorithm == "event-video";
  if ((is_network || is_video) && method.model.empty())
    return invalid("networks require a model; give its file", location + ".model");
  if (is_video && !method.codes.empty()) {
    return invalid("a scan of views opens one cell after another and uses no other patterns; remove them",
                   location + ".codes");
  }
  if (!is_network && !is_video && !method.model.empty()) {
    return invalid(cat("the method ", method.algorithm, " does not use a model; give the patterns as \"codes\""),
                   location + ".model");
  }
  if ((method.algorithm == "external") == method.command.empty()) {
    return invalid("\"command\" names the program of the algorithm \"external\"; give both or neither",
                   location + ".command");
  }
  if (!is_network && (method.passes > 1 || !method.camera.empty())) {
    return invalid("\"passes\" and \"camera\" only apply to networks; remove them", location);
  }
  return {};
}

Result<void> check_sensor(const SensorConfig& sensor, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_positive(sensor.gain, location + ".gain"));
  E2LF_RETURN_IF_ERROR(check_positive(sensor.tau.value_or(1.0F), location + ".tau"));
  if (sensor.sigma_i.value_or(0.0F) < 0.0F) {
    return invalid("a standard deviation cannot be negative; use zero or more", location + ".sigma_i");
  }
  return check_count(sensor.cycles, location + ".cycles");
}

template <typename Item, typename Check>
Result<void> check_each(const std::vector<Item>& items, const std::string& location, const Check& check) {
  for (size_t i = 0; i < items.size(); ++i) E2LF_RETURN_IF_ERROR(check(items[i], cat(location, "[", i, "]")));
  return {};
}

Result<void> check(const ComparisonConfig& config, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_names(config.methods, location + ".methods"));
  E2LF_RETURN_IF_ERROR(check_names(config.scenes, location + ".scenes"));
  E2LF_RETURN_IF_ERROR(check_names(config.sensors, location + ".sensors"));
  E2LF_RETURN_IF_ERROR(check_each(config.methods, location + ".methods", check_method));
  E2LF_RETURN_IF_ERROR(check_each(config.sensors, location + ".sensors", check_sensor));
  for (const GroupConfig& group : config.scenes) {
    if (group.scenes.empty() || group.step == 0) {
      return invalid(
          cat("the group ", group.name, " requires at least one scene, and a step of at least 1; correct it"),
          location + ".scenes");
    }
  }
  const std::set<uint64_t> seeds(config.seeds.begin(), config.seeds.end());
  if (seeds.empty() || seeds.size() != config.seeds.size()) {
    return invalid("the list of seeds is empty or contains a seed twice; use e.g. [1, 2, 3]", location + ".seeds");
  }
  std::vector<std::string> metrics;
  for (const Metric& metric : all_metrics()) metrics.emplace_back(metric.name);
  for (const std::string& name : config.metrics) {
    E2LF_RETURN_IF_ERROR(check_word(name, metrics, location + ".metrics"));
  }
  return {};
}

}  // namespace

Result<ComparisonConfig> config_from_json(const Json& json, const std::string& location) {
  if (!json.is_object())
    return fail(ErrorCode::kFormat, location, "the configuration is not a JSON object; enclose it in { }");
  ComparisonConfig config;
  const std::string root = location + ": $";
  OptionReader reader(json, root);
  visit_config(config, reader);
  E2LF_RETURN_IF_ERROR(reader.finish());
  E2LF_RETURN_IF_ERROR(check(config, root));
  return config;
}

Json to_json(const ComparisonConfig& config) {
  FieldWriter writer;
  visit_config(config, writer);
  return std::move(writer).json();
}

}  // namespace e2lf::compare
