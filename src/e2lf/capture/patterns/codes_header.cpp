// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/codes_header.h"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {
namespace {

constexpr std::string_view kKey = "e2lf_pattern_";

std::string row_text(const Json& row) {
  if (row.is_string()) return row.get<std::string>();
  std::vector<std::string> numbers;
  for (const Json& value : row) numbers.push_back(json_line(value));
  return join(numbers, ",");
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

/// Returns a row in the form that codes_from_json() reads.
Result<Json> row_from(const std::string& text, const std::string& location) {
  if (text.find_first_not_of("01") == std::string::npos) return Json(text);
  Json row = Json::array();
  for (const std::string& part : split(text, ',')) {
    float value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) {
      return Error{ErrorCode::kFormat,
                   cat("\"", part, "\" is not a transmittance; repair the header, or give the patterns"), location};
    }
    row.push_back(value);
  }
  return row;
}

}  // namespace

HeaderLines codes_to_header(const Codes& codes) {
  const Json patterns = codes_to_json(codes)["patterns"];
  HeaderLines header;
  for (size_t n = 0; n < patterns.size(); ++n) {
    std::vector<std::string> rows;
    for (const Json& row : patterns[n]) rows.push_back(row_text(row));
    header.emplace_back(cat(kKey, n + 1), join(rows, "/"));
  }
  return header;
}

Result<std::optional<Codes>> codes_from_header(const HeaderLines& header, const std::string& location) {
  const auto count = static_cast<size_t>(
      std::count_if(header.begin(), header.end(), [](const auto& line) { return line.first.starts_with(kKey); }));
  if (count == 0) return std::optional<Codes>();
  Json patterns = Json::array();
  for (size_t n = 1; n <= count; ++n) {
    const std::string key = cat(kKey, n), at = cat(location, ": ", key);
    const auto line = std::find_if(header.begin(), header.end(), [&](const auto& pair) { return pair.first == key; });
    if (line == header.end()) {
      return Error{ErrorCode::kFormat, "this pattern is missing in the header; give the patterns", at, Setting::kCodes};
    }
    Json rows = Json::array();
    for (const std::string& text : split(line->second, '/')) {
      E2LF_ASSIGN_OR_RETURN(Json row, row_from(text, at));
      rows.push_back(std::move(row));
    }
    patterns.push_back(std::move(rows));
  }
  E2LF_ASSIGN_OR_RETURN(Codes codes, codes_from_json(Json{{"patterns", std::move(patterns)}}, location));
  return std::optional(std::move(codes));
}

}  // namespace e2lf::capture
