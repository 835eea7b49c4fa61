// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/config.h"

#include <algorithm>
#include <optional>

#include "e2lf/learn/run/config_fields.h"
#include "e2lf/model/unet.h"

namespace e2lf::learn {
namespace {

Error invalid(const std::string& message, const std::string& location) {
  return Error{ErrorCode::kInvalidValue, message, location};
}

Result<void> read_input(const Json& json, const std::string& location, std::vector<model::InputGroup>& input) {
  if (json.is_null()) return {};
  if (!json.is_array() || json.empty()) {
    return invalid("input is a list of objects; see docs/training.md", location);
  }
  input.clear();
  for (const Json& item : json) {
    std::string kind;
    model::InputGroup group;
    OptionReader reader(item, location);
    reader.read("kind", kind).read("scale", group.scale);
    E2LF_RETURN_IF_ERROR(reader.finish());
    const auto* const found = std::find(std::begin(kInputKindNames), std::end(kInputKindNames), kind);
    if (found == std::end(kInputKindNames)) {
      return invalid(cat("unknown kind \"", kind, "\"; use one of ",
                         join({std::begin(kInputKindNames), std::end(kInputKindNames)})),
                     location);
    }
    group.kind = static_cast<model::InputKind>(found - std::begin(kInputKindNames));
    input.push_back(group);
  }
  return {};
}

/// Reads the fields that an object contains; absent ones keep their values. The first error is kept.
class FieldReader {
 public:
  FieldReader(const Json& object, const std::string& location) : reader_(object, location) {}

  template <typename Field>
  void operator()(const char* key, Field& field, const char*) {
    reader_.read(key, field);
  }
  template <typename Enum, size_t kCount>
  void choice(const char* key, Enum& field, const char* const (&names)[kCount], const char*) {
    std::string name = names[static_cast<size_t>(field)];
    reader_.read(key, name);
    const auto found = std::find(std::begin(names), std::end(names), name);
    if (found == std::end(names)) {
      note(invalid(cat(key, " is not \"", name, "\"; write ", join({std::begin(names), std::end(names)}, " or ")),
                   reader_.child_location(key)));
    } else {
      field = static_cast<Enum>(found - std::begin(names));
    }
  }
  template <typename List>
  void section(const char* key, const List& list) {
    FieldReader inner(reader_.child(key), reader_.child_location(key));
    list(inner);
    note(inner.finish());
  }
  void inputs(const char* key, std::vector<model::InputGroup>& groups, const char*) {
    note(read_input(reader_.child(key), reader_.child_location(key), groups));
  }

  [[nodiscard]] Result<void> finish() const {
    if (error_) return *error_;
    return reader_.finish();
  }

 private:
  void note(const Result<void>& result) {
    if (!result && !error_) error_ = result.error();
  }

  OptionReader reader_;
  std::optional<Error> error_;
};

/// Writes every field.
class FieldWriter {
 public:
  template <typename Field>
  void operator()(const char* key, const Field& field, const char*) {
    json_[key] = field;
  }
  template <typename Enum, size_t kCount>
  void choice(const char* key, const Enum& field, const char* const (&names)[kCount], const char*) {
    json_[key] = names[static_cast<size_t>(field)];
  }
  template <typename List>
  void section(const char* key, const List& list) {
    FieldWriter inner;
    list(inner);
    json_[key] = std::move(inner.json_);
  }
  void inputs(const char* key, const std::vector<model::InputGroup>& groups, const char*) {
    json_[key] = Json::array();
    for (const model::InputGroup& group : groups) {
      json_[key].push_back({{"kind", kInputKindNames[static_cast<size_t>(group.kind)]}, {"scale", group.scale}});
    }
  }

  [[nodiscard]] Json json() && { return std::move(json_); }

 private:
  Json json_ = Json::object();
};

/// Writes a row of a Markdown table for every field: its path, default and meaning.
class TableWriter {
 public:
  explicit TableWriter(std::string path = "") : path_(std::move(path)) {}

  template <typename Field>
  void operator()(const char* key, const Field& field, const char* meaning) {
    add_row(key, Json(field).dump(), meaning);
  }
  void operator()(const char* key, const float& field, const char* meaning) {
    add_row(key, json_number(field).dump(), meaning);
  }
  template <typename Enum, size_t kCount>
  void choice(const char* key, const Enum& field, const char* const (&names)[kCount], const char* meaning) {
    add_row(key, Json(names[static_cast<size_t>(field)]).dump(), meaning);
  }
  template <typename List>
  void section(const char* key, const List& list) {
    TableWriter inner(path_ + key + ".");
    list(inner);
    rows_ += inner.rows_;
  }
  void inputs(const char* key, const std::vector<model::InputGroup>& groups, const char* meaning) {
    std::string all;
    for (const model::InputGroup& group : groups) {
      all += cat(all.empty() ? "" : ", ", json_number(group.scale).dump(), " x ",
                 kInputKindNames[static_cast<size_t>(group.kind)]);
    }
    add_row(key, all, meaning);
  }

  [[nodiscard]] const std::string& rows() const { return rows_; }

 private:
  void add_row(const char* key, const std::string& value, const std::string& meaning) {
    rows_ += cat("| `", path_, key, "` | ", value, " |", meaning.empty() ? "" : " ", meaning, " |\n");
  }

  std::string path_, rows_;
};

bool is_intensity(const model::InputGroup& group) {
  return group.kind == model::InputKind::kIntensity;
}

Result<void> check_patterns(const PatternConfig& patterns, capture::MeasurementKind measurement,
                            const std::string& location) {
  if (patterns.complementary && (patterns.black_first || patterns.num_patterns % 2 != 0)) {
    return invalid(
        "complementary patterns come in pairs, none of them black; set black_first to false and an even "
        "num_patterns",
        location);
  }
  if (patterns.whole_cycle && (!patterns.black_first || patterns.num_patterns < 5 || patterns.num_patterns % 2 == 0)) {
    return invalid(
        "a whole cycle begins and ends with black: leave black_first at true and set num_patterns to 2N + 1 for N "
        "codes, at least 5",
        location);
  }
  const size_t least = patterns.black_first || capture::has_events(measurement) ? 2 : 1;
  if (patterns.num_patterns < least)
    return invalid(cat("num_patterns must be at least ", least, "; raise it"), location);
  if (measurement == capture::MeasurementKind::kLensArray && patterns.num_patterns != 1) {
    return invalid("behind a lens array the aperture is open; set num_patterns to 1 and black_first to false",
                   location);
  }
  return {};
}

Result<void> check_sensor(const SensorConfig& sensor, const std::string& start, const std::string& location) {
  if (sensor.subwindows == 1) return {};
  if (sensor.subwindows == 0 || sensor.camera.empty() || sensor.camera_share < 1.0 || !start.empty()) {
    return invalid("sub-windows need physical pixels in all samples: set camera, camera_share to 1 and no start",
                   location + ".subwindows");
  }
  return {};
}

Result<void> check_network(const NetworkConfig& network, const std::string& location) {
  if (network.type != "unet" && network.type != "recnet") {
    return invalid(cat("unknown network type \"", network.type, "\"; use unet or recnet"), location);
  }
  if (network.widths.empty() || network.widths.size() != network.blocks.size()) {
    return invalid("widths and blocks need one entry per level; make the lists equally long", location);
  }
  return {};
}

Result<void> check_train(const TrainConfig& train, const std::string& location) {
  if (train.batch == 0 || train.steps == 0 || train.patch == 0 || train.log_steps == 0 || train.evaluate_steps == 0 ||
      train.checkpoint_steps == 0) {
    return invalid("patch, batch, steps and the intervals must be positive; raise them", location);
  }
  if (train.optimiser != "muon" && train.optimiser != "adam") {
    return invalid(cat("unknown optimiser \"", train.optimiser, "\"; use muon or adam"), location);
  }
  if (!(train.error_power > 0.0)) return invalid("error_power must be positive; 1 is the squared error", location);
  return {};
}

}  // namespace

Result<Config> config_from_json(const Json& json, const std::string& location) {
  Config config;
  // Without a black first pattern, counts measure changes of the intensity, but not the intensity.
  const Json& patterns = json.is_object() && json.contains("patterns") ? json["patterns"] : Json();
  const bool is_black_first = !patterns.is_object() || patterns.value("black_first", Json(true)) != Json(false);
  if (!is_black_first) std::erase_if(config.input, is_intensity);
  FieldReader reader(json, location);
  visit_fields(config, reader);
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!is_black_first && std::any_of(config.input.begin(), config.input.end(), is_intensity)) {
    return invalid("intensity inputs need a black first pattern; leave them out or set patterns.black_first",
                   location + ".input");
  }
  const auto measurement = model::measurement_of(config.input);
  if (!measurement) return invalid(measurement.error().message, location + ".input");
  E2LF_RETURN_IF_ERROR(check_patterns(config.patterns, *measurement, location + ".patterns"));
  if (!config.sensor.camera.empty() && !capture::has_events(*measurement)) {
    return invalid("a camera with physical pixels generates events, but `input` contains none; leave the camera out",
                   location + ".sensor.camera");
  }
  if (*measurement == capture::MeasurementKind::kLensArray && config.train.patch % capture::kLensPixels != 0) {
    return invalid("a patch must contain an integral number of lenses; make it a multiple of 8",
                   location + ".train.patch");
  }
  E2LF_RETURN_IF_ERROR(check_sensor(config.sensor, config.start, location + ".sensor"));
  E2LF_RETURN_IF_ERROR(check_network(config.network, location + ".network"));
  E2LF_RETURN_IF_ERROR(check_train(config.train, location + ".train"));
  if (config.precision != "float32" && config.precision != "bfloat16") {
    return invalid("precision is \"float32\" or \"bfloat16\"; write one of them", location + ".precision");
  }
  if (config.data.synthesiser.size < static_cast<int64_t>(config.train.patch)) {
    return invalid("synthesised light fields are smaller than a patch; raise data.synthesiser.size",
                   location + ".train.patch");
  }
  return config;
}

Json to_json(const Config& config) {
  FieldWriter writer;
  visit_fields(config, writer);
  return std::move(writer).json();
}

std::string config_table() {
  TableWriter table;
  const Config defaults;
  visit_fields(defaults, table);
  return table.rows();
}

model::Network make_network(const Config& config) {
  const size_t num_patterns = config.patterns.num_patterns;
  size_t channels = 0;
  for (const model::InputGroup& group : config.input) {
    // Otherwise, a sub-window is to the inputs what a transition is.
    const bool is_of_patterns = group.kind == model::InputKind::kCamera || config.sensor.subwindows == 1;
    const size_t seen = is_of_patterns ? num_patterns : (num_patterns - 1) * config.sensor.subwindows + 1;
    channels += model::num_input_channels({group}, seen);
  }
  if (config.network.type == "recnet") return model::recnet(channels);
  return model::unet({.input_channels = channels,
                      .widths = {config.network.widths.begin(), config.network.widths.end()},
                      .blocks = {config.network.blocks.begin(), config.network.blocks.end()},
                      .head_width = config.network.head_width,
                      .head_blocks = config.network.head_blocks});
}

}  // namespace e2lf::learn
