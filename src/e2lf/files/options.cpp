// SPDX-License-Identifier: MIT
#include "e2lf/files/options.h"

#include <algorithm>
#include <charconv>

namespace e2lf {

Json json_number(float value) {
  char text[32];
  const auto written = std::to_chars(text, text + sizeof(text), value);
  double shortest = 0.0;
  std::from_chars(text, written.ptr, shortest);
  return shortest;
}

bool is_nested_deeply(std::string_view text) {
  constexpr int kMostLevels = 64;
  int level = 0;
  bool is_text = false;
  for (size_t i = 0; i < text.size() && level <= kMostLevels; ++i) {
    if (is_text && text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      is_text = !is_text;
    } else if (!is_text) {
      if (text[i] == '[' || text[i] == '{') ++level;
      if (text[i] == ']' || text[i] == '}') --level;
    }
  }
  return level > kMostLevels;
}

Result<Json> parse_json(const std::string& text, const std::string& name) {
  if (is_nested_deeply(text)) return fail(ErrorCode::kFormat, name, "the JSON is nested more deeply than 64 levels");
  try {
    return Json::parse(text, nullptr, /*allow_exceptions=*/true, /*ignore_comments=*/true);
  } catch (const nlohmann::json::parse_error& error) {
    return fail(ErrorCode::kFormat, cat(name, ": byte ", error.byte), "not valid JSON; ", error.what());
  } catch (const nlohmann::json::out_of_range& error) {
    return fail(ErrorCode::kFormat, name, "a number is too large; ", error.what());
  }
}

Result<Json> read_json(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return parse_json(std::string(bytes.begin(), bytes.end()), path.string());
}

Result<void> apply_override(Json& config, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    return fail(ErrorCode::kInvalidValue, assignment,
                "an override needs the form key=value; write e.g. train.batch=16");
  }
  const auto holds_keys = [](const Json& value) { return value.is_null() || value.is_object(); };
  if (!holds_keys(config)) {
    return fail(ErrorCode::kInvalidValue, assignment, "the configuration is not an object; write { ... } in its file");
  }
  Json* node = &config;
  std::string key = assignment.substr(0, equals);
  for (size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.')) {
    node = &(*node)[key.substr(0, dot)];
    key = key.substr(dot + 1);
    if (!holds_keys(*node)) {
      return fail(ErrorCode::kInvalidValue, assignment,
                  "the override goes through a value that is not an object; shorten its key");
    }
  }
  const std::string text = assignment.substr(equals + 1);
  Json value = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  (*node)[key] = value.is_discarded() ? Json(text) : std::move(value);
  return {};
}

OptionReader::OptionReader(const Json& object, std::string location)
    : object_(&object), location_(std::move(location)) {
  if (!object.is_object() && !object.is_null()) {
    error_ =
        Error{ErrorCode::kFormat, cat("expected an object, found ", object.type_name(), "; write { ... }"), location_};
  }
}

const Json& OptionReader::child(const std::string& key) {
  static const Json kNull;
  known_.push_back(key);
  return object_->is_object() && object_->contains(key) ? object_->at(key) : kNull;
}

void OptionReader::fail(const std::string& key, const char* kind) {
  if (error_) return;
  const std::string text = json_line(object_->at(key));
  error_ = Error{ErrorCode::kInvalidValue, cat("a value of the wrong type or out of range (", text, "); give ", kind),
                 child_location(key)};
}

Result<void> OptionReader::finish() const {
  if (error_) return *error_;
  if (!object_->is_object()) return {};
  for (const auto& [key, value] : object_->items()) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      return e2lf::fail(ErrorCode::kInvalidValue, child_location(key), "unknown key \"", key, "\"; ",
                        suggestion(key, known_));
    }
  }
  return {};
}

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace) + "\n";
}

std::string json_line(const Json& json) {
  return json.dump(-1, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace);
}

}  // namespace e2lf
