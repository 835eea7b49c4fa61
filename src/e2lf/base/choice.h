// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/text.h"

namespace e2lf {

/// A word in options and files, and the value that it stands for. A table of choices names the values of an enum.
template <typename T>
struct Choice {
  const char* word;
  T value;
};

/// Returns the words of a table.
template <typename T, size_t N>
[[nodiscard]] std::vector<std::string> words_of(const Choice<T> (&table)[N]) {
  std::vector<std::string> words;
  for (const Choice<T>& choice : table) words.emplace_back(choice.word);
  return words;
}

/// Returns the word for a value; the table must contain it.
template <typename T, size_t N>
[[nodiscard]] constexpr const char* word_of(T value, const Choice<T> (&table)[N]) {
  return std::find_if(table, table + N - 1, [&](const Choice<T>& choice) { return value == choice.value; })->word;
}

/// Returns what a word stands for. Fails with kInvalidValue, suggesting the nearest word of the table; `what` says in
/// the message what the word is of.
template <typename T, size_t N>
[[nodiscard]] Result<T> choice_of(std::string_view word, const Choice<T> (&table)[N], std::string_view what = "choice",
                                  const std::string& location = {}) {
  for (const Choice<T>& choice : table) {
    if (word == choice.word) return choice.value;
  }
  return fail(ErrorCode::kInvalidValue, location, "unknown ", what, " \"", word, "\"; ",
              suggestion(word, words_of(table)));
}

}  // namespace e2lf
