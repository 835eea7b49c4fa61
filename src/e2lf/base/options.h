// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/file.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

namespace e2lf {

using Json = nlohmann::ordered_json;

/// Parses JSON text (comments allowed). Fails with kFormat; the location is `name` and the byte.
[[nodiscard]] Result<Json> parse_json(const std::string& text, const std::string& name);
[[nodiscard]] Result<Json> read_json(const std::filesystem::path& path);

/// Applies "a.b.c=value" (value: JSON, or a bare string) to a configuration, making objects on the way.
/// Fails with kInvalidValue when there is no "=" or a step is not an object.
[[nodiscard]] Result<void> apply_override(Json& config, const std::string& assignment);

/// Reads the fields of one JSON object into a plain options struct and refuses what it does not know:
///
///   OptionReader reader(json, "config.json: $.train");
///   reader.read("batch", options.batch).read("steps", options.steps);
///   return reader.finish();   // the first wrong type, or an unknown key with the nearest known one
///
/// Absent keys keep the struct's default.
class OptionReader {
 public:
  OptionReader(const Json& object, std::string location);

  template <typename T>
  OptionReader& read(const std::string& key, T& field) {
    return convert(key, [&](const Json& value) { field = value.get<T>(); });
  }
  template <typename T>
  OptionReader& read(const std::string& key, std::optional<T>& field) {
    return convert(key, [&](const Json& value) { field = value.get<T>(); });
  }

  /// The nested object under `key` (null when absent), to be read by another reader.
  [[nodiscard]] const Json& child(const std::string& key);
  [[nodiscard]] std::string child_location(const std::string& key) const { return location_ + "." + key; }

  /// Success, or the first error met: a value of the wrong type, or an unknown key.
  [[nodiscard]] Result<void> finish() const;

 private:
  template <typename Convert>
  OptionReader& convert(const std::string& key, Convert&& set) {
    known_.push_back(key);
    if (!object_->is_object() || !object_->contains(key)) return *this;
    try {
      set(object_->at(key));
    } catch (const nlohmann::json::exception&) {
      fail(key);
    }
    return *this;
  }
  void fail(const std::string& key);

  const Json* object_;
  std::string location_;
  std::vector<std::string> known_;
  std::optional<Error> error_;
};

}  // namespace e2lf
