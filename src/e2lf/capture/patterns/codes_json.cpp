// SPDX-License-Identifier: MIT
// Reads and writes patterns as JSON; declared in codes_io.h.
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"

namespace e2lf::capture {
namespace {

Result<std::vector<float>> read_row(const Json& row, const std::string& location) {
  std::vector<float> values;
  if (row.is_string()) {
    for (const char digit : row.get_ref<const std::string&>()) {
      if (digit != '0' && digit != '1') {
        return Error{ErrorCode::kInvalidValue, cat("\"", digit, "\" in a row of text; use only 0 and 1, or numbers"),
                     location};
      }
      values.push_back(digit == '1' ? 1.0F : 0.0F);
    }
    return values;
  }
  if (!row.is_array())
    return Error{ErrorCode::kFormat, "a row must be a list of numbers or a string of digits 0 and 1", location};
  for (const Json& value : row) {
    if (!value.is_number()) {
      return Error{ErrorCode::kFormat, cat("a ", value.type_name(), " in a row; give numbers in [0, 1]"), location};
    }
    values.push_back(value.get<float>());
  }
  return values;
}

/// Appends one pattern; the first row of the first pattern sets the sizes.
Result<void> read_pattern(const Json& pattern, const std::string& location, Codes& codes) {
  if (!pattern.is_array()) return Error{ErrorCode::kFormat, "a pattern must be a list of rows", location};
  if (codes.num_patterns == 0) codes.views_y = pattern.size();
  if (pattern.size() != codes.views_y) {
    return Error{ErrorCode::kShape,
                 cat(pattern.size(), " rows, the first pattern has ", codes.views_y, "; make them equal"), location};
  }
  for (size_t row = 0; row < pattern.size(); ++row) {
    const std::string row_location = cat(location, "[", row, "]");
    E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, read_row(pattern[row], row_location));
    if (codes.values.empty()) codes.views_x = values.size();
    if (values.size() != codes.views_x) {
      return Error{ErrorCode::kShape,
                   cat(values.size(), " cells, the first row has ", codes.views_x, "; make them equal"), row_location};
    }
    codes.values.insert(codes.values.end(), values.begin(), values.end());
  }
  ++codes.num_patterns;
  return {};
}

}  // namespace

Result<Codes> codes_from_json(const Json& json, const std::string& location) {
  OptionReader reader(json, location + ": $");
  const Json& patterns = reader.child("patterns");
  const std::string patterns_location = reader.child_location("patterns");
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!patterns.is_array()) {
    return Error{ErrorCode::kFormat, "expected a list of patterns; write {\"patterns\": [...]}", patterns_location};
  }
  Codes codes;
  for (size_t n = 0; n < patterns.size(); ++n) {
    E2LF_RETURN_IF_ERROR(read_pattern(patterns[n], cat(patterns_location, "[", n, "]"), codes));
  }
  E2LF_RETURN_IF_ERROR(validate(codes, location));
  return codes;
}

Json codes_to_json(const Codes& codes) {
  const bool binary = is_binary(codes);
  Json patterns = Json::array();
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    Json rows = Json::array();
    for (size_t view_y = 0; view_y < codes.views_y; ++view_y) {
      const auto row = codes.pattern(n).subspan(view_y * codes.views_x, codes.views_x);
      std::string text;
      for (const float value : row) text += value == 1.0F ? '1' : '0';
      Json numbers = Json::array();
      for (const float value : row) numbers.push_back(json_number(value));
      rows.push_back(binary ? Json(text) : std::move(numbers));
    }
    patterns.push_back(std::move(rows));
  }
  return {{"patterns", std::move(patterns)}};
}

}  // namespace e2lf::capture
