// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/choice.h"

/// The kinds of values of options.
namespace e2lf::program {

/// The placeholders of values in --help. They also identify the options that name files: --config resolves their values
/// (recorded_paths.cpp), and completion offers bundled files for them.
inline constexpr char kPathType[] = "PATH", kModelType[] = "MODEL", kCodesType[] = "PATTERNS", kCameraType[] = "CAMERA";
/// For verbs that accept any file or folder.
inline constexpr char kThingType[] = "PATH|MODEL";

/// Makes every option with a numeric value reject malformed numbers: a sign if the type has none, values beyond its
/// range, NaN and infinity, and numbers that are not decimal. CLI11 would wrap or clip them silently.
void check_numbers(CLI::App& app);

/// Returns a validator that rejects integers outside [least, most], with a message in words.
[[nodiscard]] CLI::Validator whole_number(int64_t least, int64_t most = INT64_MAX);

/// Returns a validator that rejects numbers that are not greater than 0.
[[nodiscard]] CLI::Validator positive_number();

/// Declares an option for an integer in [least, most], whose default is shown.
template <typename T>
CLI::Option* add_count(CLI::App& app, const std::string& name, T& value, int64_t least, int64_t most,
                       const std::string& help) {
  return app.add_option(name, value, help)->check(whole_number(least, most))->capture_default_str();
}

/// Declares an option for one of the choices, whose default is shown.
template <typename T, size_t N>
CLI::Option* add_choice(CLI::App& app, const std::string& name, T& value, const Choice<T> (&choices)[N],
                        const std::string& help) {
  const auto take = [&value, &choices](const CLI::results_t& words) {
    value = *choice_of(words.back(), choices);
    return true;
  };
  return app.add_option(name, take, help)
      ->type_name("TEXT")
      ->check(CLI::IsMember(words_of(choices)))
      ->default_str(word_of(value, choices));
}

/// Declares an option for one of several words, whose default is shown.
CLI::Option* add_choice(CLI::App& app, const std::string& name, std::string& value,
                        const std::vector<std::string>& choices, const std::string& help);

/// Returns all flags, e.g. "-m" and "--model".
[[nodiscard]] std::vector<std::string> flags_of(const CLI::App& app);

/// Declares that neither of two options can be given without the other.
inline void add_pair(CLI::Option* first, CLI::Option* second) {
  first->needs(second);
  second->needs(first);
}

/// After set_completing(), run_subverb() and Verb::run() only print the words with which their arguments, of which the
/// last may be incomplete, can continue; see cli/completion.bash.
void set_completing();
[[nodiscard]] bool is_completing();
/// Prints the words that begin with `begin`, and those that may follow the words behind the name of a verb.
void print_candidates(const std::vector<std::string>& words, const std::string& begin);
void print_candidates(const CLI::App& app, std::vector<std::string> words);

}  // namespace e2lf::program

/// Names the type of all path options; CLI11 would call it TEXT.
template <>
constexpr const char* CLI::detail::type_name<std::filesystem::path>() {
  return e2lf::program::kPathType;
}
