// SPDX-License-Identifier: MIT
// Writes manual pages; declared in declared_verbs.h.
#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/cli/declared_verbs.h"
#include "e2lf/cli/version.h"

namespace e2lf::cli {
namespace {

/// Escapes text so that roff finds no requests or escapes in it.
std::string roff(const std::string& text) {
  std::string result = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char letter : text) {
    if (letter == '\\') {
      result += "\\e";
    } else if (letter == '-') {
      result += "\\-";
    } else {
      result += letter;
    }
  }
  return result;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string command_of(const DeclaredVerb& verb) {
  return verb.name.empty() ? "e2lf" : "e2lf " + verb.name;
}

std::string synopsis(const DeclaredVerb& verb) {
  std::string text = bold(command_of(verb));
  if (!verb.subverbs.empty()) return cat(text, " ", italic("VERB"), " [", italic("FLAGS"), "]\n");
  for (const DeclaredOption& option : verb.options) {
    if (option.argument.empty()) continue;
    text += option.is_required ? " " + italic(option.argument) : cat(" [", italic(option.argument), "]");
  }
  return cat(text, " [", italic("FLAGS"), "]\n");
}

std::string option_entry(const DeclaredOption& option) {
  std::vector<std::string> names;
  if (!option.argument.empty()) names.push_back(italic(option.argument));
  for (const std::string& name : option.names()) names.push_back(bold(name));
  std::string entry = cat(".TP\n", join(names));
  if (!option.names().empty() && option.takes_value) entry += " " + italic(option.placeholder());
  entry += "\n" + roff(option.help);
  if (!option.default_value.empty()) entry += roff(cat("; default: ", option.default_value));
  return entry + (option.is_required ? "; required\n" : "\n");
}

/// Returns the options by group, in the order in which the groups occur.
std::string options_text(const DeclaredVerb& verb) {
  std::vector<std::string> groups;
  for (const DeclaredOption& option : verb.options) {
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string text;
  for (const std::string& group : groups) {
    text += group == "Options" ? ".SH OPTIONS\n" : cat(".SH \"", roff(group), "\"\n");
    for (const DeclaredOption& option : verb.options) {
      if (option.group == group) text += option_entry(option);
    }
  }
  return text;
}

std::string subverbs_text(const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs) {
  std::string text = ".SH VERBS\n";
  for (const auto& [name, other] : subverbs_of(verb, verbs)) {
    text += cat(".TP\n", bold(name), "\n", roff(other->summary), "\n");
  }
  return text;
}

std::string see_also(const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs) {
  std::vector<std::string> pages;
  for (const DeclaredVerb& other : verbs) {
    const bool is_own = other.name == verb.name;
    const bool is_related = other.name.empty() || verb.name.empty() || other.name.starts_with(verb.name + " ") ||
                            verb.name.starts_with(other.name + " ");
    if (!is_own && is_related) pages.push_back(bold(manual_name(other)) + "(1)");
  }
  return pages.empty() ? "" : cat(".SH \"SEE ALSO\"\n", join(pages, ",\n"), "\n");
}

}  // namespace

std::string manual_name(const DeclaredVerb& verb) {
  std::string name = command_of(verb);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string manual_page(const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs) {
  const std::string summary = verb.name.empty()      ? "light fields from the events of a coded-aperture camera"
                              : verb.summary.empty() ? "see the verbs below"
                                                     : verb.summary;
  std::string page =
      cat(".TH ", roff(manual_name(verb)), " 1 \"\" \"e2lf ", kVersion, "\" \"User Commands\"\n", ".SH NAME\n",
          roff(manual_name(verb)), " \\- ", roff(summary), "\n.SH SYNOPSIS\n", synopsis(verb));
  if (!verb.description.empty()) page += cat(".SH DESCRIPTION\n", roff(verb.description), "\n");
  page += verb.subverbs.empty() ? options_text(verb) : subverbs_text(verb, verbs);
  if (!verb.example.empty()) page += cat(".SH EXAMPLE\n.EX\n", roff(verb.example), "\n.EE\n");
  page +=
      ".SH \"EXIT STATUS\"\n0: success. 1: failure. 2: usage error. 3: live input failed early. 130, 143: ended by a "
      "signal.\n";
  return page + see_also(verb, verbs);
}

}  // namespace e2lf::cli
