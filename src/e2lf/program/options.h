// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/choice.h"

/// The options of verbs: the kinds of their values, their help, and the groups in which it shows them.
namespace e2lf::program {

/// The placeholders of values in --help. They also identify the options that name files: --config resolves their values
/// (outputs.cpp), and completion offers bundled files for them.
inline constexpr char kPathType[] = "PATH", kModelType[] = "MODEL", kCodesType[] = "PATTERNS", kCameraType[] = "CAMERA";
/// For verbs that accept any file or folder.
inline constexpr char kThingType[] = "PATH|MODEL";

/// Returns the placeholder of the values of an option, without the checks of them that CLI11 appends.
[[nodiscard]] std::string value_type(const CLI::Option& option);

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

/// The groups of options; OptionGroup declares them. The word before the colon is that of
/// --help=WORD. Options without a group are those that --help always shows.
inline constexpr char kRunOptions[] = "run: configuration file, number of threads and seed",
                      kNetworkOptions[] = "network: its arithmetic, what computes it, and the brightness of its output",
                      kCycleOptions[] = "cycles: when the patterns of a recording change",
                      kRecordingOptions[] = "recordings: which part of them is read, and their clock",
                      kTableOptions[] = "tables: recordings that do not state their format, sensor or columns",
                      kCameraOptions[] = "cameras: settings of a live camera",
                      kLightFieldOptions[] = "light-fields: which views are read, and how files store them",
                      kOrientationOptions[] = "orientation: turned or mirrored views",
                      kMapOptions[] = "map: view, range and points of disparity maps of light fields",
                      kStreamOptions[] = "stream: simulation event by event, of scenes that move",
                      kSensorOptions[] = "sensor: constants of the paper's event models",
                      kDisplayOptions[] = "display: size and orientation of the patterns on the display";

/// The options that apply to recordings alone, and not to event images.
inline const std::vector<std::string> kOptionsOfRecordings = {kCycleOptions, kRecordingOptions, kTableOptions,
                                                              kCameraOptions};

/// While it exists, new options of `app` are in this group.
class OptionGroup {
 public:
  OptionGroup(CLI::App& app, const char* group) : app_(app), before_(app.option_defaults()->get_group()) {
    app.option_defaults()->group(group);
  }
  ~OptionGroup() { app_.option_defaults()->group(before_); }
  OptionGroup(const OptionGroup&) = delete;
  OptionGroup& operator=(const OptionGroup&) = delete;

 private:
  CLI::App& app_;
  std::string before_;
};

/// Returns the words of the groups that the options of `app` have, in the order of their declaration.
[[nodiscard]] std::vector<std::string> help_groups(const CLI::App& app);

/// Returns the text of --help: everything if there are few options, and otherwise those without a group and the list of
/// groups.
[[nodiscard]] std::string short_help(const CLI::App& app);

/// Returns the text of --help-all.
[[nodiscard]] std::string whole_help(const CLI::App& app);

/// Returns the text of --help=WORD, or nothing if no option of `app` has this group.
[[nodiscard]] std::optional<std::string> group_help(const CLI::App& app, const std::string& word);

}  // namespace e2lf::program

/// Names the type of all path options; CLI11 would call it TEXT.
template <>
constexpr const char* CLI::detail::type_name<std::filesystem::path>() {
  return e2lf::program::kPathType;
}
