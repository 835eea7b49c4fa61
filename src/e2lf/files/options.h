// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

/// A structure declares its fields once, in a function that passes each of them to a visitor. OptionReader reads them
/// from JSON, and FieldWriter writes them. A visitor is called as visit(key, field), visit.choice(key, field, choices)
/// for an enum, visit.section(key, fields) for a nested object, and visit.list(key, items, fields) for a list of
/// objects. E2LF_VISIT(object, visit, name, ...) visits members of an object under their own names.
#define E2LF_VISIT(object, visit, ...) \
  [](auto& of, auto& with) { NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(E2LF_VISIT_MEMBER, __VA_ARGS__)) }(object, visit)
#define E2LF_VISIT_MEMBER(name) with(#name, of.name);

namespace e2lf {

using Json = nlohmann::ordered_json;

/// Returns the number as it is usually written (0.3, not 0.30000001192092896). Reading it as a float gives the same
/// float.
[[nodiscard]] Json json_number(float value);

/// Returns whether JSON text has brackets at more than 64 levels. The values that it describes must not be copied: each
/// level takes a part of the stack.
[[nodiscard]] bool is_nested_deeply(std::string_view text);

/// Parses JSON text, which may contain comments. Fails with kFormat; the location is `name` and the byte.
[[nodiscard]] Result<Json> parse_json(const std::string& text, const std::string& name);
[[nodiscard]] Result<Json> read_json(const std::filesystem::path& path);

/// Applies "a.b.c=value" to a configuration, where value is JSON or a bare string, and creates the objects on the way.
/// Fails with kInvalidValue if there is no "=" or if a step is not an object.
[[nodiscard]] Result<void> apply_override(Json& config, const std::string& assignment);

/// Reads the fields of one JSON object into a plain options struct and rejects unknown keys:
///
///   OptionReader reader(json, "config.json: $.train");
///   reader.read("batch", options.batch).read("steps", options.steps);
///   return reader.finish();   // the first wrong type, or an unknown key with the nearest known one
///
/// A key that is absent leaves the default of the struct.
class OptionReader {
 public:
  OptionReader(const Json& object, std::string location);

  template <typename T>
  OptionReader& read(const std::string& key, T& field) {
    return convert<T>(key, [&](T value) { field = std::move(value); });
  }
  template <typename T>
  OptionReader& read(const std::string& key, std::optional<T>& field) {
    return convert<T>(key, [&](T value) { field = std::move(value); });
  }

  template <typename T>
  void operator()(const char* key, T& field) {
    read(key, field);
  }
  /// An unknown word is an error of kind `unknown`.
  template <typename Enum, size_t kCount>
  void choice(const char* key, Enum& field, const Choice<Enum> (&choices)[kCount],
              ErrorCode unknown = ErrorCode::kInvalidValue) {
    std::string word = word_of(field, choices);
    read(key, word);
    const auto chosen = choice_of(word, choices, key);
    if (chosen) field = *chosen;
    if (!chosen) note(Error{unknown, chosen.error().message, child_location(key)});
  }
  template <typename Fields>
  void section(const char* key, const Fields& fields) {
    OptionReader inner(child(key), child_location(key));
    fields(inner);
    note(inner.finish());
  }
  template <typename Item, typename Fields>
  void list(const char* key, std::vector<Item>& items, const Fields& fields) {
    const Json& array = child(key);
    if (array.is_null()) return;
    if (!array.is_array()) {
      return note(Error{ErrorCode::kFormat, "expected a list; write [{ ... }, ...]", child_location(key)});
    }
    items.clear();
    for (size_t i = 0; i < array.size(); ++i) {
      OptionReader inner(array[i], cat(child_location(key), "[", i, "]"));
      fields(items.emplace_back(), inner);
      note(inner.finish());
    }
  }

  /// Returns the nested object under `key`, to be read by another reader, or null if it is absent.
  [[nodiscard]] const Json& child(const std::string& key);
  [[nodiscard]] std::string child_location(const std::string& key) const { return location_ + "." + key; }

  /// Returns success, or the first error found: a value of the wrong type or an unknown key.
  [[nodiscard]] Result<void> finish() const;

 private:
  template <typename T, typename Set>
  OptionReader& convert(const std::string& key, Set&& set) {
    known_.push_back(key);
    if (!object_->is_object() || !object_->contains(key)) return *this;
    const Json& value = object_->at(key);
    try {
      if (!fits<T>(value)) {
        fail(key, kind_of<T>());
      } else {
        set(value.get<T>());
      }
    } catch (const nlohmann::json::exception&) {
      fail(key, kind_of<T>());
    }
    return *this;
  }

  /// Returns true if the value fits T. It is stricter than the JSON library, which converts -1, 2.5 and true to any
  /// number type.
  template <typename T>
  static bool fits(const Json& value) {
    if constexpr (std::is_same_v<T, bool>) {
      return value.is_boolean();
    } else if constexpr (std::is_integral_v<T>) {
      return value.is_number_unsigned() ? std::in_range<T>(value.get<uint64_t>())
                                        : value.is_number_integer() && std::in_range<T>(value.get<int64_t>());
    } else if constexpr (std::is_floating_point_v<T>) {
      return value.is_number();
    } else {
      return true;
    }
  }
  /// Returns the words with which errors describe a value of type T.
  template <typename T>
  static const char* kind_of() {
    if constexpr (std::is_same_v<T, bool>) {
      return "true or false";
    } else if constexpr (std::is_integral_v<T>) {
      return std::is_unsigned_v<T> ? "a whole number from 0" : "a whole number";
    } else if constexpr (std::is_floating_point_v<T>) {
      return "a number";
    } else {
      return std::is_convertible_v<T, std::string> ? "a text" : "a list";
    }
  }
  void fail(const std::string& key, const char* kind);
  void note(const Result<void>& result) {
    if (!result && !error_) error_ = result.error();
  }

  const Json* object_;
  std::string location_;
  std::vector<std::string> known_;
  std::optional<Error> error_;
};

/// Writes every field. Numbers in float32 are written as json_number() does.
class FieldWriter {
 public:
  template <typename Field>
  void operator()(const char* key, const Field& field) {
    json_[key] = json_of(field);
  }
  template <typename Enum, size_t kCount>
  void choice(const char* key, const Enum& field, const Choice<Enum> (&choices)[kCount], ErrorCode /*unknown*/ = {}) {
    json_[key] = word_of(field, choices);
  }
  template <typename Fields>
  void section(const char* key, const Fields& fields) {
    FieldWriter inner;
    fields(inner);
    json_[key] = std::move(inner.json_);
  }
  template <typename Item, typename Fields>
  void list(const char* key, const std::vector<Item>& items, const Fields& fields) {
    json_[key] = Json::array();
    for (const Item& item : items) {
      FieldWriter inner;
      fields(item, inner);
      json_[key].push_back(std::move(inner.json_));
    }
  }

  [[nodiscard]] Json json() && { return std::move(json_); }

 private:
  template <typename Field>
  static Json json_of(const Field& field) {
    return field;
  }
  template <typename Field>
  static Json json_of(const std::optional<Field>& field) {
    return field ? json_of(*field) : Json();
  }
  static Json json_of(float field) { return json_number(field); }

  Json json_ = Json::object();
};

/// Returns a number as JSON, or null if it is not finite, which JSON cannot express.
[[nodiscard]] Json finite_or_null(double value);

/// Formats a JSON value as text: json_text() indents it and ends it with a new line, json_line() writes one line
/// without a new line. They never throw: bytes that are not valid UTF-8, which names of files may contain, become
/// U+FFFD.
[[nodiscard]] std::string json_text(const Json& json);
[[nodiscard]] std::string json_line(const Json& json);

}  // namespace e2lf
