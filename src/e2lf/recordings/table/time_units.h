// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::table {

/// Parses "us", "usec", "microseconds" and the like, also in some other languages; returns kAuto for other words.
[[nodiscard]] TimeUnit parse_time_unit(std::string_view word);

/// Returns the duration of a unit in microseconds; kAuto is microseconds.
[[nodiscard]] double us_per(TimeUnit unit);

/// Returns "s", "ms", "us" or "ns".
[[nodiscard]] const char* time_unit_name(TimeUnit unit);

/// Returns the unit of this duration in seconds, or kAuto if there is none.
[[nodiscard]] TimeUnit unit_of_tick(double tick_s);

/// Returns the words of a text in lower case. A capital after a small letter begins a word ("timestampNs"), the Greek
/// letter of "us" is replaced by a Latin one, and "micro seconds" becomes one word.
[[nodiscard]] std::vector<std::string> words_of(std::string_view text);

/// A word in lower case, a number, or one of the characters = : /.
struct Token {
  std::string word = {};
  std::optional<double> number = {};
};

/// Returns the words, numbers and marks of a text: "1ns" is a number and a word, "evt3" a word, and "10^-6" a number.
[[nodiscard]] std::vector<Token> tokens_of(std::string_view text);

/// Returns the duration that begins at token i, in seconds: "us", "100 ns", "1/1000 s", "1 MHz", and at the end also
/// "1e-6". Returns 0 if none does.
[[nodiscard]] double duration_at(const std::vector<Token>& tokens, size_t i);

[[nodiscard]] bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words);

}  // namespace e2lf::recordings::table
