// SPDX-License-Identifier: MIT
#include "e2lf/program/help.h"

#include <sstream>

#include "e2lf/base/text.h"
#include "e2lf/program/option_values.h"

namespace e2lf::program {
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
