// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/column_names.h"

#include <algorithm>

namespace e2lf::recordings::table {
namespace {

struct KnownName {
  Field field;
  std::string_view name;
  bool is_prefix;
};

constexpr KnownName kNames[] = {
    {Field::kT, "t", false},     {Field::kT, "ts", false},     {Field::kT, "timestamp", true},
    {Field::kT, "time", false},  {Field::kT, "times", false},  {Field::kT, "zeit", true},
    {Field::kT, "temps", true},  {Field::kT, "tiempo", true},  {Field::kT, "tempo", true},
    {Field::kT, "时间", true},   {Field::kX, "x", false},      {Field::kX, "xs", false},
    {Field::kX, "col", false},   {Field::kX, "column", false}, {Field::kY, "y", false},
    {Field::kY, "ys", false},    {Field::kY, "row", false},    {Field::kP, "p", false},
    {Field::kP, "ps", false},    {Field::kP, "pol", false},    {Field::kP, "pols", false},
    {Field::kP, "polari", true}, {Field::kP, "on", false},     {Field::kP, "sign", false}};

bool says_nothing(std::string_view word) {
  return is_one_of(word, {"event",    "events",    "ev",       "px",     "pixel",      "pixels",      "pos",
                          "position", "positions", "coord",    "coords", "coordinate", "coordinates", "addr",
                          "address",  "loc",       "location", "in",     "data",       "dataset",     "dvs"});
}

/// Splits a name into what stands outside and inside its first brackets.
std::pair<std::string, std::string> at_brackets(std::string_view name) {
  constexpr std::string_view kOpening = "([{<", kClosing = ")]}>";
  const size_t begin = name.find_first_of(kOpening);
  if (begin == std::string_view::npos || begin == name.find_first_not_of(" \"'#")) return {std::string(name), ""};
  const size_t end = std::min(name.find(kClosing[kOpening.find(name[begin])], begin), name.size());
  return {std::string(name.substr(0, begin)) + " " + std::string(name.substr(std::min(end + 1, name.size()))),
          std::string(name.substr(begin + 1, end - begin - 1))};
}

/// Returns the words and numbers of a name without those that say nothing, up to what says since when times count.
std::vector<Token> tokens_of_name(std::string_view name) {
  std::vector<Token> tokens = tokens_of(name);
  const auto is_since = [](const Token& token) {
    return is_one_of(token.word, {"since", "from", "after", "relative"});
  };
  tokens.erase(std::find_if(tokens.begin(), tokens.end(), is_since), tokens.end());
  std::erase_if(tokens, [](const Token& token) {
    return says_nothing(token.word) || is_one_of(token.word, {"=", ":"});
  });
  if (tokens.size() > 1 && tokens[0].word == "time" && tokens[1].word == "stamp") {
    tokens.erase(tokens.begin());
    tokens[0].word = "timestamp";
  }
  return tokens;
}

/// Returns the first duration from token i on in seconds, or 0.
double first_duration(const std::vector<Token>& tokens, size_t i) {
  for (; i < tokens.size(); ++i) {
    if (const double duration = duration_at(tokens, i); duration > 0) return duration;
  }
  return 0;
}

}  // namespace

ColumnName parse_column_name(std::string_view name) {
  const auto [outside, inside] = at_brackets(name);
  const std::vector<Token> tokens = tokens_of_name(outside);
  ColumnName result;
  if (tokens.empty()) return result;
  const std::string& main = tokens[0].word;
  result.is_xy = tokens.size() == 1 && main == "xy";
  // A name that is unknown may still state a unit.
  result.tick_s = first_duration(tokens, 1);
  if (result.tick_s == 0) result.tick_s = first_duration(tokens_of_name(inside), 0);
  if (tokens.size() == 1 && is_one_of(main, {"tus", "tms", "tns", "tsec", "tusec", "tmsec", "tnsec"})) {
    result.tick_s = us_per(parse_time_unit(main.substr(1))) * 1e-6;
    result.field = Field::kT;
  } else if (tokens.size() == 1 && result.tick_s == 0 && main != "s" && parse_time_unit(main) != TimeUnit::kAuto) {
    result.tick_s = us_per(parse_time_unit(main)) * 1e-6;
    result.field = Field::kT;
    result.rank = 2 * std::size(kNames);
  }
  result.unit = unit_of_tick(result.tick_s);
  for (const KnownName& known : kNames) {
    if (known.is_prefix ? !main.starts_with(known.name) : main != known.name) continue;
    // Any other second word changes the meaning: "t_offset".
    const auto is_of_unit = [&](const Token& token) {
      return known.field == Field::kT && result.tick_s > 0 &&
             (token.number || token.word == "/" || duration_at({token}, 0) > 0);
    };
    if (!std::all_of(tokens.begin() + 1, tokens.end(), is_of_unit)) return result;
    result.field = known.field;
    // A time whose unit is stated is preferred.
    const bool is_vague = known.field == Field::kT && result.tick_s == 0;
    result.rank = static_cast<size_t>(&known - kNames) + (is_vague ? std::size(kNames) : 0);
    return result;
  }
  return result;
}

KnownColumns find_fields(std::span<const std::string> names) {
  KnownColumns columns;
  std::array<size_t, kNumFields> ranks{};
  for (size_t i = 0; i < names.size(); ++i) {
    const ColumnName name = parse_column_name(names[i]);
    if (!name.field) continue;
    const size_t field = of(*name.field);
    if (columns[field] && ranks[field] <= name.rank) continue;
    columns[field] = i;
    ranks[field] = name.rank;
  }
  return columns;
}

}  // namespace e2lf::recordings::table
