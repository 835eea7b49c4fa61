// SPDX-License-Identifier: MIT
#include "e2lf/cli/declared_verbs.h"

#include <sstream>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_values.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::cli {
namespace {

/// The list to which verbs add their declaration while declared_verbs() runs; otherwise null.
std::vector<DeclaredVerb>* g_declared = nullptr;

/// Returns the words in braces of "TEXT:{auto,float32}", or none if there are no braces.
std::vector<std::string> choices_of(const std::string& type) {
  const size_t begin = type.find('{'), end = type.find('}');
  std::vector<std::string> choices;
  if (begin == std::string::npos || end == std::string::npos) return choices;
  std::istringstream words(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(words, word, ',');) choices.push_back(word);
  return choices;
}

bool is_number_type(const std::string& type) {
  return type.starts_with("INT") || type.starts_with("UINT") || type.starts_with("FLOAT");
}

std::vector<std::string> bundled_of(const std::string& type) {
  if (type == kModelType || type == kCodesType || type == kThingType) return bundled_names(kBundledModels);
  if (type == kCameraType) return bundled_names(kBundledCameras);
  return {};
}

DeclaredOption declared_option(const CLI::Option& option) {
  DeclaredOption declared;
  for (const std::string& name : option.get_snames()) declared.short_names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) declared.long_names.push_back("--" + name);
  if (option.get_positional()) declared.argument = option.get_name(/*positional=*/true);
  declared.help = option.get_description();
  declared.group = option.get_group();
  declared.default_value = option.get_default_str();
  declared.takes_value = option.get_items_expected_max() > 0;
  declared.is_required = option.get_required();
  declared.type = option.get_type_name();
  declared.choices = choices_of(declared.type);
  declared.bundled = bundled_of(declared.type);
  declared.is_number = is_number_type(declared.type);
  return declared;
}

/// Returns the example without its heading "Example:".
std::string example_of(const CLI::App& app) {
  const std::string footer = app.get_footer();
  const size_t line = footer.find("\n  ");
  return line == std::string::npos ? footer : footer.substr(line + 3);
}

}  // namespace

std::vector<std::string> DeclaredOption::names() const {
  std::vector<std::string> all = short_names;
  all.insert(all.end(), long_names.begin(), long_names.end());
  return all;
}

std::string DeclaredOption::placeholder() const {
  if (!takes_value) return "";
  if (!choices.empty()) return "{" + join(choices, ",") + "}";
  return is_number ? "NUMBER" : type;
}

bool are_verbs_asked() {
  return g_declared != nullptr;
}

void declare_verb(const std::string& name, const CLI::App& app) {
  DeclaredVerb verb{name, "", app.get_description(), example_of(app), {}, {}};
  for (const CLI::Option* option : app.get_options()) verb.options.push_back(declared_option(*option));
  g_declared->push_back(std::move(verb));
}

void declare_subverbs(const std::string& prefix, const std::vector<VerbEntry>& entries) {
  const size_t own = g_declared->size();
  g_declared->push_back({prefix, "", "", "", {}, {}});
  for (const VerbEntry& entry : entries) {
    (*g_declared)[own].subverbs.emplace_back(entry.name);
    const size_t begin = g_declared->size();
    static_cast<void>(entry.run({}));
    if (g_declared->size() > begin) (*g_declared)[begin].summary = entry.summary;
  }
}

std::vector<DeclaredVerb> declared_verbs(const std::vector<VerbEntry>& entries) {
  std::vector<DeclaredVerb> declared;
  g_declared = &declared;
  declare_subverbs("", entries);
  g_declared = nullptr;
  return declared;
}

std::vector<std::pair<std::string, const DeclaredVerb*>> subverbs_of(const DeclaredVerb& verb,
                                                                     const std::vector<DeclaredVerb>& verbs) {
  std::vector<std::pair<std::string, const DeclaredVerb*>> found;
  for (const std::string& name : verb.subverbs) {
    const std::string full = verb.name.empty() ? name : verb.name + " " + name;
    for (const DeclaredVerb& other : verbs) {
      if (other.name == full) found.emplace_back(name, &other);
    }
  }
  return found;
}

}  // namespace e2lf::cli
