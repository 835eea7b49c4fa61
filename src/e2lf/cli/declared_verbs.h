// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "e2lf/cli/verb.h"

/// The declarations of the verbs, and the shell completion (completion.cpp) and manual pages (manual_page.cpp) that are
/// generated from them.
namespace e2lf::cli {

/// A flag, option or argument, as --help shows it.
struct DeclaredOption {
  std::vector<std::string> short_names, long_names;  ///< names with their dashes; empty for a positional argument
  std::string argument;                              ///< name of the positional argument; otherwise empty
  std::string help, group, default_value;
  bool takes_value = false, is_required = false;
  bool is_number = false;
  std::vector<std::string> choices;  ///< all allowed values; empty if any value is allowed
  std::vector<std::string> bundled;  ///< names of bundled files that it accepts
  std::string type;                  ///< the type of the value that --help shows

  /// Returns all names, the short ones first.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Returns the placeholder of the value: "PATH", "NUMBER", "{auto,float32}"; empty for a flag.
  [[nodiscard]] std::string placeholder() const;
};

/// A verb or subverb, with the words that call it: "codes show".
struct DeclaredVerb {
  std::string name, summary, description, example;
  std::vector<DeclaredOption> options;
  std::vector<std::string> subverbs;  ///< verbs below a verb that only groups others
};

/// Returns the declarations of all verbs of the list and their subverbs, in order, without running any.
[[nodiscard]] std::vector<DeclaredVerb> declared_verbs(const std::vector<VerbEntry>& entries);

/// Returns the subverbs of a verb that only groups others: the name of each, and its declaration among `verbs`.
[[nodiscard]] std::vector<std::pair<std::string, const DeclaredVerb*>> subverbs_of(
    const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs);

/// While declared_verbs() is running, Verb::run() and run_subverb() only register their declaration with these
/// functions.
[[nodiscard]] bool are_verbs_asked();
void declare_verb(const std::string& name, const CLI::App& app);
void declare_subverbs(const std::string& prefix, const std::vector<VerbEntry>& entries);

/// Returns the script that completes e2lf's verbs, flags and values in a shell: bash, zsh or fish. The first of `verbs`
/// is e2lf itself. Fails with kInvalidValue for any other shell.
[[nodiscard]] Result<std::string> completion_script(const std::string& shell, const std::vector<DeclaredVerb>& verbs);

/// Returns the name of a verb's manual page without its section: "e2lf-codes-show".
[[nodiscard]] std::string manual_name(const DeclaredVerb& verb);

/// Returns the manual page (roff, section 1) of a verb. `verbs` are all verbs, to which the page may refer.
[[nodiscard]] std::string manual_page(const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs);

}  // namespace e2lf::cli
