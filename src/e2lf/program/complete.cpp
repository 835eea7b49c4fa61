// SPDX-License-Identifier: MIT
// The completion of shells; declared in verb.h.
#include <cstdio>
#include <sstream>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/verb.h"

namespace e2lf::program {
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

std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  return flags;
}

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
  // Bash splits "--model=NAME" into three words.
  if (!words.empty() && words.back() == "=") words.emplace_back();
  std::erase(words, "=");
  const std::string current = words.empty() ? "" : words.back(),
                    previous = words.size() < 2 ? "" : words[words.size() - 2];
  print_candidates(candidates(app, previous, current), current);
}

}  // namespace e2lf::program
