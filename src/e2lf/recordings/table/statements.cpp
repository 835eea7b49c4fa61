// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/statements.h"

#include <algorithm>
#include <cctype>

namespace e2lf::recordings::table {
namespace {

bool is_about_times(std::string_view word) {
  return is_one_of(word, {"t", "ts", "time", "times", "timestamp", "timestamps", "unit", "units", "clock", "temporal"});
}

bool is_about_ticks(std::string_view word) {
  return is_one_of(word, {"resolution", "tick", "ticks", "precision", "granularity", "unit", "units", "base", "scale",
                          "timebase", "timescale", "step", "lsb"});
}

bool is_filler(std::string_view word) {
  return is_about_times(word) || is_about_ticks(word) ||
         is_one_of(word,
                   {"is", "are", "in", "of", "one", "a", "the", "as", "each", "duration", "equals", "=", ":", "/"});
}

/// Returns true for words that make a duration another one than that of the times.
bool is_of_other_duration(std::string_view word) {
  return is_one_of(
      word, {"exposure", "accumulation", "integration", "recording", "recorded", "start",   "begin",    "end",
             "offset",   "shift",        "refractory",  "refr",      "window",   "delay",   "latency",  "frame",
             "frames",   "display",      "trigger",     "zone",      "day",      "checked", "sampling", "period"});
}

/// Returns the duration of a tick of the clock, in seconds: "resolution: 1 ns", "1 us per tick", "ticks per second:
/// 1e6".
double tick_of(const std::vector<Token>& clause) {
  const auto skip = [&](size_t i) {
    while (i < clause.size() && !clause[i].number && is_filler(clause[i].word)) ++i;
    return i;
  };
  for (size_t i = 0; i < clause.size(); ++i) {
    if (!is_about_ticks(clause[i].word)) continue;
    const bool is_rate = i + 2 < clause.size() && clause[i + 1].word == "per" &&
                         parse_time_unit(clause[i + 2].word) == TimeUnit::kSeconds;
    if (is_rate) {
      const size_t place = skip(i + 3);
      const double rate = place < clause.size() ? clause[place].number.value_or(0) : 0;
      return rate > 0 ? 1 / rate : 0;
    }
    if (const double after = duration_at(clause, skip(i + 1)); after > 0) return after;
    const size_t last = i > 0 && clause[i - 1].word == "per" ? i - 1 : i;
    if (last < 2 || !clause[last - 2].number) continue;
    if (const double before = duration_at({clause[last - 2], clause[last - 1]}, 0); before > 0) return before;
  }
  return 0;
}

/// Returns the unit that a clause about times states, or kAuto.
TimeUnit unit_of(const std::vector<Token>& clause) {
  const bool has_number =
      std::any_of(clause.begin(), clause.end(), [](const Token& t) { return t.number.has_value(); });
  bool is_told = false;
  for (size_t i = 0; i + 1 < clause.size(); ++i) {
    // Beside a number, only what directly follows the word for times is its unit.
    is_told = is_about_times(clause[i].word) || (is_told && (!has_number || is_filler(clause[i].word)));
    const TimeUnit unit = parse_time_unit(clause[i + 1].word);
    if (!is_told || unit == TimeUnit::kAuto) continue;
    if (is_about_times(clause[i].word) || is_one_of(clause[i].word, {"in", "are", "is", "as", "=", ":"})) return unit;
  }
  return TimeUnit::kAuto;
}

/// Returns 1 for a word for ON, 0 for OFF, and nothing for others.
std::optional<int> polarity_of(std::string_view word) {
  if (is_one_of(word, {"on", "positive", "pos", "bright", "brighter", "increase", "inc", "up"})) return 1;
  if (is_one_of(word, {"off", "negative", "neg", "dark", "darker", "decrease", "dec", "down"})) return 0;
  return std::nullopt;
}

}  // namespace

TimeStatement times_in_sentence(std::string_view text) {
  TimeStatement found;
  for (size_t begin = 0; begin < text.size();) {
    // A comma between digits belongs to a number.
    const auto ends = [&](size_t i) {
      const bool is_within = i + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[i + 1])) != 0;
      return text[i] == ';' || (text[i] == ',' && !is_within);
    };
    size_t end = begin;
    while (end < text.size() && !ends(end)) ++end;
    const std::vector<Token> clause = tokens_of(text.substr(begin, end - begin));
    begin = end + 1;
    const auto is_other = [](const Token& token) { return is_of_other_duration(token.word); };
    if (std::any_of(clause.begin(), clause.end(), is_other)) continue;
    if (found.tick_s == 0) found.tick_s = tick_of(clause);
    if (found.unit == TimeUnit::kAuto) found.unit = unit_of(clause);
  }
  return found;
}

PolarityStatement polarities_in_sentence(std::string_view text) {
  PolarityStatement found;
  const std::vector<Token> tokens = tokens_of(text);
  const auto word = [&](size_t i) { return i < tokens.size() ? std::string_view(tokens[i].word) : ""; };
  const auto number = [&](size_t i) { return i < tokens.size() ? tokens[i].number : std::nullopt; };
  const auto set = [&](std::optional<int> polarity, std::optional<double> value) {
    if (polarity && value) (*polarity == 1 ? found.on : found.off) = value;
  };
  if (std::any_of(tokens.begin(), tokens.end(), [](const Token& token) { return token.word == "bias"; })) return found;
  for (size_t i = 0; i < tokens.size(); ++i) {
    const bool are_pairs = word(i + 1) == "/" && word(i + 3) == "=" && word(i + 5) == "/";
    if (are_pairs && polarity_of(word(i)) && polarity_of(word(i + 2))) {
      set(polarity_of(word(i)), number(i + 4));
      set(polarity_of(word(i + 2)), number(i + 6));
      return found;
    }
    if (!is_one_of(word(i + 1), {"=", ":", "is", "means"})) continue;
    set(polarity_of(word(i + 2)), number(i));
    set(polarity_of(word(i)), number(i + 2));
  }
  // "c_on = 0" alone is a threshold.
  const auto names_polarity = [](const Token& token) { return token.word.starts_with("polar") || token.word == "p"; };
  const bool is_about_it = std::any_of(tokens.begin(), tokens.end(), names_polarity);
  return is_about_it || (found.on && found.off) ? found : PolarityStatement();
}

}  // namespace e2lf::recordings::table
