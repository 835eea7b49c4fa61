// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "e2lf/cli/verb.h"

/// What the verbs declare of themselves, for texts that are made of it: completion in shells, manual pages.
namespace e2lf::cli {

/// One flag, option or argument, as --help shows it.
struct DeclaredOption {
  std::vector<std::string> short_names, long_names;  ///< with their dashes; none = an argument by its place
  std::string argument;                              ///< its name where it may be given by its place; else empty
  std::string help, group, default_value;
  bool takes_value = false, is_required = false;
  bool is_number = false;
  std::vector<std::string> choices;  ///< all its values; empty = any
  std::vector<std::string> bundled;  ///< names that it takes besides files
  std::string type;                  ///< what --help calls its value

  /// All names, the short ones first.
  [[nodiscard]] std::vector<std::string> names() const;
  /// What stands for its value: "PATH", "NUMBER", "{auto,float32}"; empty for a flag.
  [[nodiscard]] std::string placeholder() const;
};

/// One verb or subverb, with the words that call it: "codes show".
struct DeclaredVerb {
  std::string name, summary, description, example;
  std::vector<DeclaredOption> options;
  std::vector<std::string> subverbs;  ///< of one that is but a list of others
};

/// All verbs of the list and their subverbs, in its order. Runs none.
[[nodiscard]] std::vector<DeclaredVerb> declared_verbs(const std::vector<VerbEntry>& entries);

/// While declared_verbs() asks, Verb::run() and run_subverb() answer by these and do nothing else.
[[nodiscard]] bool are_verbs_asked();
void declare_verb(const std::string& name, const CLI::App& app);
void declare_subverbs(const std::string& prefix, const std::vector<VerbEntry>& entries);

}  // namespace e2lf::cli
