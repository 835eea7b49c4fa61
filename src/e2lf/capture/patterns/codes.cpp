// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/codes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <string_view>

#include "e2lf/base/text.h"

namespace e2lf::capture {

Result<void> validate(const Codes& codes, const std::string& location) {
  if (codes.values.empty())
    return fail(ErrorCode::kShape, location, "there are no aperture patterns; give at least one");
  if (codes.values.size() != codes.num_patterns * codes.pattern_size()) {
    return fail(ErrorCode::kShape, location, codes.values.size(), " transmittances do not make patterns of ",
                shape_text({codes.num_patterns, codes.views_y, codes.views_x}), "; give one for each cell");
  }
  // Written so that NaN is refused.
  const auto refused = std::ranges::find_if(codes.values, [](float v) { return !(v >= 0.0F && v <= 1.0F); });
  if (refused == codes.values.end()) return {};
  const auto index = static_cast<size_t>(refused - codes.values.begin());
  const size_t cell = index % codes.pattern_size();
  return fail(ErrorCode::kInvalidValue, location, "the transmittance ", *refused, " of pattern ",
              index / codes.pattern_size() + 1, ", row ", cell / codes.views_x, ", column ", cell % codes.views_x,
              " is not in [0, 1]; scale the patterns");
}

bool is_black_first(const Codes& codes) {
  if (codes.num_patterns == 0) return false;
  const auto first = codes.pattern(0);
  return std::ranges::all_of(first, [](float value) { return value == 0.0F; });
}

bool is_binary(const Codes& codes) {
  return std::ranges::all_of(codes.values, [](float value) { return value == 0.0F || value == 1.0F; });
}

std::vector<float> light_efficiency(const Codes& codes) {
  std::vector<float> means;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    const auto pattern = codes.pattern(n);
    const double sum = std::accumulate(pattern.begin(), pattern.end(), 0.0);
    means.push_back(static_cast<float>(sum / static_cast<double>(pattern.size())));
  }
  return means;
}

Codes complement(const Codes& codes) {
  Codes result = codes;
  for (float& value : result.values) value = 1.0F - value;
  return result;
}

Codes with_open_aperture(const Codes& codes) {
  Codes extended = codes;
  ++extended.num_patterns;
  extended.values.resize(extended.values.size() + extended.pattern_size(), 1.0F);
  return extended;
}

Codes default_codes() {
  constexpr size_t kViews = 8;
  constexpr float kNear = 1.5F, kFar = 5.5F;  // centres of the first and second half of an axis
  constexpr float kCentres[3][2] = {{kFar, kNear}, {kFar, kFar}, {kNear, kFar}};  // {view_y, view_x}
  constexpr float kRadiusSquared = 3.0F;                                          // a 4x4 square without its corners
  Codes codes(4, kViews, kViews);
  for (size_t n = 1; n < codes.num_patterns; ++n) {
    for (size_t view_y = 0; view_y < kViews; ++view_y) {
      for (size_t view_x = 0; view_x < kViews; ++view_x) {
        const float dy = static_cast<float>(view_y) - kCentres[n - 1][0];
        const float dx = static_cast<float>(view_x) - kCentres[n - 1][1];
        if (dy * dy + dx * dx <= kRadiusSquared) codes.pattern(n)[view_y * kViews + view_x] = 1.0F;
      }
    }
  }
  return codes;
}

Codes whole_cycle(const Codes& codes) {
  Codes whole(2 * codes.num_patterns + 1, codes.views_y, codes.views_x);
  const Codes inverses = complement(codes);
  auto end = std::copy(codes.values.begin(), codes.values.end(), whole.values.begin());
  end = std::copy(inverses.values.begin(), inverses.values.end(), end);
  std::copy_n(codes.values.begin(), codes.num_patterns > 0 ? codes.pattern_size() : 0, end);
  return whole;
}

std::optional<Codes> codes_of_whole_cycle(const Codes& codes) {
  constexpr float kRounding = 1e-6F;
  if (codes.num_patterns < 5 || codes.num_patterns % 2 == 0) return std::nullopt;
  Codes shown((codes.num_patterns - 1) / 2, codes.views_y, codes.views_x);
  std::copy_n(codes.values.begin(), shown.values.size(), shown.values.begin());
  const bool is_whole = std::equal(codes.values.begin(), codes.values.end(), whole_cycle(shown).values.begin(),
                                   [](float value, float expected) { return std::abs(value - expected) <= kRounding; });
  return is_whole ? std::optional(std::move(shown)) : std::nullopt;
}

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
    const auto value = parse_number<float>(part);
    if (!value) {
      return fail(ErrorCode::kFormat, location, "\"", part,
                  "\" is not a transmittance; repair the header, or give the patterns");
    }
    row.push_back(*value);
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
  const auto count =
      static_cast<size_t>(std::ranges::count_if(header, [](const auto& line) { return line.first.starts_with(kKey); }));
  if (count == 0) return std::optional<Codes>();
  Json patterns = Json::array();
  for (size_t n = 1; n <= count; ++n) {
    const std::string key = cat(kKey, n), at = cat(location, ": ", key);
    const auto line = std::ranges::find_if(header, [&](const auto& pair) { return pair.first == key; });
    if (line == header.end()) {
      return Error{ErrorCode::kFormat, "this pattern is missing in the header; give the patterns", at, "codes"};
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

namespace {

Result<std::vector<float>> read_row(const Json& row, const std::string& location) {
  std::vector<float> values;
  if (row.is_string()) {
    for (const char digit : row.get_ref<const std::string&>()) {
      if (digit != '0' && digit != '1') {
        return fail(ErrorCode::kInvalidValue, location, "\"", digit,
                    "\" in a row of text; use only 0 and 1, or numbers");
      }
      values.push_back(digit == '1' ? 1.0F : 0.0F);
    }
    return values;
  }
  if (!row.is_array())
    return fail(ErrorCode::kFormat, location, "a row must be a list of numbers or a string of digits 0 and 1");
  for (const Json& value : row) {
    if (!value.is_number()) {
      return fail(ErrorCode::kFormat, location, "a ", value.type_name(), " in a row; give numbers in [0, 1]");
    }
    values.push_back(value.get<float>());
  }
  return values;
}

/// Appends one pattern; the first row of the first pattern sets the sizes.
Result<void> read_pattern(const Json& pattern, const std::string& location, Codes& codes) {
  if (!pattern.is_array()) return fail(ErrorCode::kFormat, location, "a pattern must be a list of rows");
  if (codes.num_patterns == 0) codes.views_y = pattern.size();
  if (pattern.size() != codes.views_y) {
    return fail(ErrorCode::kShape, location, pattern.size(), " rows, the first pattern has ", codes.views_y,
                "; make them equal");
  }
  for (size_t row = 0; row < pattern.size(); ++row) {
    const std::string row_location = cat(location, "[", row, "]");
    E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, read_row(pattern[row], row_location));
    if (codes.values.empty()) codes.views_x = values.size();
    if (values.size() != codes.views_x) {
      return fail(ErrorCode::kShape, row_location, values.size(), " cells, the first row has ", codes.views_x,
                  "; make them equal");
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
    return fail(ErrorCode::kFormat, patterns_location, "expected a list of patterns; write {\"patterns\": [...]}");
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

namespace {

/// Returns a row of cells separated by spaces, which makes them approximately square.
std::string row_text(std::span<const float> row) {
  constexpr std::string_view kLevels = ".:-=+*#";
  std::string text;
  for (const float value : row) {
    text += kLevels[static_cast<size_t>(std::lround(value * static_cast<float>(kLevels.size() - 1)))];
    text += ' ';
  }
  text.pop_back();
  return text;
}

}  // namespace

std::string codes_text(const Codes& codes) {
  E2LF_REQUIRE(validate(codes, "").ok(), "the patterns are not valid");
  constexpr size_t kPatternsPerLine = 4, kGap = 3;  // spaces between patterns
  const std::vector<float> efficiency = light_efficiency(codes);
  const size_t width = std::max<size_t>(2 * codes.views_x - 1, 9) + kGap;
  std::string text;
  for (size_t begin = 0; begin < codes.num_patterns; begin += kPatternsPerLine) {
    std::vector<std::string> lines(1 + codes.views_y);
    const auto append = [width](std::string& line, std::string cells) {
      cells.resize(std::max(width, cells.size()), ' ');
      line += cells;
    };
    for (size_t n = begin; n < std::min(begin + kPatternsPerLine, codes.num_patterns); ++n) {
      append(lines[0], cat(n + 1, ": ", std::lround(efficiency[n] * 100.0F), " %"));
      for (size_t view_y = 0; view_y < codes.views_y; ++view_y) {
        append(lines[1 + view_y], row_text(codes.pattern(n).subspan(view_y * codes.views_x, codes.views_x)));
      }
    }
    if (begin > 0) text += '\n';
    for (const std::string& line : lines) text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  return text;
}

}  // namespace e2lf::capture
