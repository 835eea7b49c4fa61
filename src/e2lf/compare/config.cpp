// SPDX-License-Identifier: MIT
#include "e2lf/compare/config.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "e2lf/compare/config_fields.h"
#include "e2lf/compare/tables.h"
#include "e2lf/files/fields.h"

namespace e2lf::compare {
namespace {

Error invalid(const std::string& message, const std::string& location) {
  return {ErrorCode::kInvalidValue, message, location};
}

/// Checks that every item has a name and that no name occurs twice.
template <typename Item>
Result<void> check_names(const std::vector<Item>& items, const std::string& location) {
  if (items.empty()) return invalid("there is nothing in this list; add something", location);
  std::set<std::string> names;
  for (size_t i = 0; i < items.size(); ++i) {
    const std::string place = cat(location, "[", i, "].name");
    if (items[i].name.empty()) return invalid("it has no name; give it one", place);
    if (!names.insert(items[i].name).second) {
      return invalid(cat("the name \"", items[i].name, "\" is given twice; change one"), place);
    }
  }
  return {};
}

Result<void> check_word(const std::string& word, const std::vector<std::string>& known, const std::string& location) {
  if (std::find(known.begin(), known.end(), word) != known.end()) return {};
  return invalid(cat("there is no \"", word, "\" here; ", suggestion(word, known)), location);
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
    return invalid("a network needs a model; give its file", location + ".model");
  if (is_video && !method.codes.empty()) {
    return invalid("a scan opens one cell after another; leave the patterns out", location + ".codes");
  }
  if (!is_network && !is_video && !method.model.empty()) {
    return invalid(cat("the ", method.algorithm, " has no model; give its patterns as \"codes\""), location + ".model");
  }
  if (!is_network && (method.passes > 1 || !method.camera.empty())) {
    return invalid("\"passes\" and \"camera\" are of networks; leave them out", location);
  }
  return {};
}

Result<void> check_sensor(const SensorConfig& sensor, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_positive(sensor.gain, location + ".gain"));
  E2LF_RETURN_IF_ERROR(check_positive(sensor.tau.value_or(1.0F), location + ".tau"));
  if (sensor.sigma_i.value_or(0.0F) < 0.0F) {
    return invalid("noise is zero or more; give a standard deviation", location + ".sigma_i");
  }
  return check_count(sensor.cycles, location + ".cycles");
}

template <typename Item, typename Check>
Result<void> check_each(const std::vector<Item>& items, const std::string& location, const Check& check) {
  for (size_t i = 0; i < items.size(); ++i) E2LF_RETURN_IF_ERROR(check(items[i], cat(location, "[", i, "]")));
  return {};
}

Result<void> check(const Config& config, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_names(config.methods, location + ".methods"));
  E2LF_RETURN_IF_ERROR(check_names(config.scenes, location + ".scenes"));
  E2LF_RETURN_IF_ERROR(check_names(config.sensors, location + ".sensors"));
  E2LF_RETURN_IF_ERROR(check_each(config.methods, location + ".methods", check_method));
  E2LF_RETURN_IF_ERROR(check_each(config.sensors, location + ".sensors", check_sensor));
  for (const GroupConfig& group : config.scenes) {
    if (group.scenes.empty() || group.step == 0) {
      return invalid(cat("the group ", group.name, " needs scenes and a step of at least 1; give them"),
                     location + ".scenes");
    }
  }
  const std::set<uint64_t> seeds(config.seeds.begin(), config.seeds.end());
  if (seeds.empty() || seeds.size() != config.seeds.size()) {
    return invalid("there must be seeds, each once; write e.g. [1, 2, 3]", location + ".seeds");
  }
  std::vector<std::string> metrics;
  for (const Metric& metric : all_metrics()) metrics.emplace_back(metric.name);
  for (const std::string& name : config.metrics) {
    E2LF_RETURN_IF_ERROR(check_word(name, metrics, location + ".metrics"));
  }
  return {};
}

}  // namespace

Result<Config> config_from_json(const Json& json, const std::string& location) {
  if (!json.is_object())
    return Error{ErrorCode::kFormat, "the configuration is not an object; write { ... }", location};
  Config config;
  const std::string root = location + ": $";
  FieldReader reader(json, root);
  visit_config(config, reader);
  E2LF_RETURN_IF_ERROR(reader.finish());
  E2LF_RETURN_IF_ERROR(check(config, root));
  return config;
}

Result<Config> read_config(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
  return config_from_json(json, path.string());
}

std::string documented_keys() {
  FieldTable table;
  const Config config;
  visit_config(config, table);
  return table.rows();
}

}  // namespace e2lf::compare
