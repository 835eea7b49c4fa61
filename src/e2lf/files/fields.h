// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/files/options.h"

/// A configuration declares its fields once, in a function that passes each of them to a visitor. FieldReader reads
/// them from JSON, and FieldWriter writes them. A visitor is called as visit(key, field), visit.choice(key, field,
/// choices) for an enum, visit.section(key, fields) for a nested object, and visit.list(key, items, fields) for a list
/// of objects. E2LF_VISIT(object, visit, name, ...) visits members of an object under their own names.
#define E2LF_VISIT(object, visit, ...) \
  [](auto& of, auto& with) { NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(E2LF_VISIT_MEMBER, __VA_ARGS__)) }(object, visit)
#define E2LF_VISIT_MEMBER(name) with(#name, of.name);

namespace e2lf {

/// Reads the fields that an object contains; absent ones keep their values. The first error is kept.
class FieldReader {
 public:
  FieldReader(const Json& object, const std::string& location) : reader_(object, location) {}

  template <typename Field>
  void operator()(const char* key, Field& field) {
    reader_.read(key, field);
  }
  template <typename Enum, size_t kCount>
  void choice(const char* key, Enum& field, const Choice<Enum> (&choices)[kCount]) {
    std::string word = word_of(field, choices);
    reader_.read(key, word);
    const auto chosen = choice_of(word, choices, key, reader_.child_location(key));
    if (chosen)
      field = *chosen;
    else
      note(chosen.error());
  }
  template <typename Fields>
  void section(const char* key, const Fields& fields) {
    FieldReader inner(reader_.child(key), reader_.child_location(key));
    fields(inner);
    note(inner.finish());
  }
  template <typename Item, typename Fields>
  void list(const char* key, std::vector<Item>& items, const Fields& fields) {
    const Json& array = reader_.child(key);
    const std::string place = reader_.child_location(key);
    if (array.is_null()) return;
    if (!array.is_array()) {
      return note(Error{ErrorCode::kInvalidValue, "expected a list; write [{ ... }, ...]", place});
    }
    items.clear();
    for (size_t i = 0; i < array.size(); ++i) {
      FieldReader inner(array[i], cat(place, "[", i, "]"));
      fields(items.emplace_back(), inner);
      note(inner.finish());
    }
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
  void operator()(const char* key, const Field& field) {
    json_[key] = field;
  }
  template <typename Field>
  void operator()(const char* key, const std::optional<Field>& field) {
    json_[key] = field ? Json(*field) : Json();
  }
  template <typename Enum, size_t kCount>
  void choice(const char* key, const Enum& field, const Choice<Enum> (&choices)[kCount]) {
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
  Json json_ = Json::object();
};

}  // namespace e2lf
