// SPDX-License-Identifier: MIT
#include "e2lf/program/options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::program {
namespace {

template <typename T>
std::string check_whole(std::string& text) {
  if (!parse_number<T>(text)) {
    return cat("\"", text, "\" is not a whole number",
               std::is_signed_v<T> ? std::string(" of 64 bits") : cat(" from 0 to ", UINT64_MAX));
  }
  // 010 would be read as octal.
  const size_t begin = text.starts_with('-'), first = std::min(text.find_first_not_of('0', begin), text.size() - 1);
  if (first > begin) text.erase(begin, first - begin);
  return {};
}

std::string check_float(std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_whole_text = !text.empty() && *end == '\0';
  return is_whole_text && std::isfinite(value) ? std::string() : cat("\"", text, "\" is not a number");
}

}  // namespace

std::string value_type(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

void check_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    // The name of the type is followed by those of its other checks. A transformation runs before the checks.
    if (type.starts_with("UINT")) option->transform(CLI::Validator(check_whole<uint64_t>, ""));
    if (type.starts_with("INT")) option->transform(CLI::Validator(check_whole<int64_t>, ""));
    if (type.starts_with("FLOAT")) option->transform(CLI::Validator(check_float, ""));
  }
}

CLI::Validator whole_number(int64_t least, int64_t most) {
  const std::string range = most == INT64_MAX ? cat("at least ", least) : cat(least, " to ", most);
  const auto check = [=](std::string& text) {
    const auto value = parse_number<int64_t>(text);
    return value && *value >= least && *value <= most ? std::string() : cat(text, " is out of range; give ", range);
  };
  return {check, range};
}

CLI::Validator positive_number() {
  const auto check = [](std::string& text) {
    return std::strtod(text.c_str(), nullptr) > 0 ? std::string()
                                                  : cat(text, " is not above 0; give a positive number");
  };
  return {check, "above 0"};
}

CLI::Option* add_choice(CLI::App& app, const std::string& name, std::string& value,
                        const std::vector<std::string>& choices, const std::string& help) {
  return app.add_option(name, value, help)->check(CLI::IsMember(choices))->capture_default_str();
}

namespace {

bool g_completes = false;

/// Returns the names of bundled files that an option accepts, or else the words in the braces of its type
/// ("TEXT:{auto,float32}").
std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type == kModelType || type == kCodesType || type == kThingType) return bundled_names(kBundledModels);
  if (type == kCameraType) return bundled_names(kBundledCameras);
  const size_t begin = type.find('{'), end = type.find('}');
  std::vector<std::string> words;
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::istringstream text(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(text, word, ',');) words.push_back(word);
  return words;
}

}  // namespace

std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  return flags;
}

namespace {

/// Returns what may stand in place of `current` behind `previous`; nothing if that is a file.
std::vector<std::string> candidates(const CLI::App& app, const std::string& previous, const std::string& current) {
  const CLI::Option* const before = previous.starts_with('-') ? app.get_option_no_throw(previous) : nullptr;
  if (before != nullptr && before->get_items_expected_max() > 0) return values_of(*before);
  if (current.starts_with('-')) return flags_of(app);
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) return values_of(*option);
  }
  return {};
}

}  // namespace

void set_completing() {
  g_completes = true;
}

bool is_completing() {
  return g_completes;
}

void print_candidates(const std::vector<std::string>& words, const std::string& begin) {
  for (const std::string& word : words) {
    if (word.starts_with(begin)) std::printf("%s\n", word.c_str());
  }
}

void print_candidates(const CLI::App& app, std::vector<std::string> words) {
  // Bash splits "--model=NAME" into three words, and "--help=GROUP" likewise.
  if (const auto help = std::ranges::find(words, "--help"); help != words.end() && help + 1 != words.end()) {
    return print_candidates(help_groups(app), words.back() == "=" ? "" : words.back());
  }
  if (!words.empty() && words.back() == "=") words.emplace_back();
  std::erase(words, "=");
  const std::string current = words.empty() ? "" : words.back(),
                    previous = words.size() < 2 ? "" : words[words.size() - 2];
  print_candidates(candidates(app, previous, current), current);
}

namespace {

/// The number of options up to which --help shows all.
constexpr size_t kMostShown = 20;

/// Returns the word of a group, or an empty one for the options without a group, which CLI11 calls "Options".
std::string word_of_group(const std::string& group) {
  const size_t colon = group.find(':');
  return colon == std::string::npos ? "" : group.substr(0, colon);
}

/// Prints the help of an app, with headings that name groups, and descriptions broken into lines.
class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(const CLI::App& app) : app_(app) {}

  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    std::string text = cat("\n", group, word_of_group(group).empty() ? ":\n" : "\n");
    for (const CLI::Option* option : options) text += make_option(option, is_positional);
    return text;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::istringstream words(option->get_description());
    std::string text;
    size_t length = 0;
    for (std::string word; words >> word; length += word.size() + 1) {
      const bool breaks = length + word.size() > kMostColumns - get_column_width();
      if (breaks) length = 0;
      text += (text.empty() ? "" : breaks ? "\n" : " ") + word;
    }
    return text;
  }

  [[nodiscard]] std::string group_text(const std::string& group) const {
    return make_group(group, false, app_.get_options([&group](const CLI::Option* option) {
      return option->get_group() == group && option->nonpositional();
    }));
  }

  /// Returns the options without a group, and a line for each group.
  [[nodiscard]] std::string short_text() const {
    std::string ungrouped;
    std::ostringstream groups;
    for (const std::string& group : app_.get_groups()) {
      const std::string word = word_of_group(group);
      if (word.empty()) {
        ungrouped += group_text(group);
      } else {
        CLI::detail::format_help(groups, "--help=" + word, group.substr(word.size() + 2), get_column_width());
      }
    }
    return cat(make_description(&app_), make_usage(&app_, app_.get_name()), make_positionals(&app_), ungrouped,
               "\nMore options:\n", groups.str(), "\n", make_footer(&app_));
  }

 private:
  static constexpr size_t kMostColumns = 110;
  const CLI::App& app_;
};

}  // namespace

std::vector<std::string> help_groups(const CLI::App& app) {
  std::vector<std::string> words;
  for (const std::string& group : app.get_groups()) {
    if (std::string word = word_of_group(group); !word.empty()) words.push_back(std::move(word));
  }
  return words;
}

std::string short_help(const CLI::App& app) {
  return flags_of(app).size() > kMostShown ? HelpFormatter(app).short_text() : whole_help(app);
}

std::string whole_help(const CLI::App& app) {
  return HelpFormatter(app).make_help(&app, app.get_name(), CLI::AppFormatMode::All);
}

std::optional<std::string> group_help(const CLI::App& app, const std::string& word) {
  for (const std::string& group : app.get_groups()) {
    if (!word.empty() && word_of_group(group) == word) return HelpFormatter(app).group_text(group).substr(1);
  }
  return std::nullopt;
}

}  // namespace e2lf::program
