// SPDX-License-Identifier: MIT
// Writes the completion of shells; declared in declared_verbs.h.
#include "e2lf/base/text.h"
#include "e2lf/cli/declared_verbs.h"

namespace e2lf::cli {
namespace {

/// Quotes a text so that bash, zsh and fish read it alike. fish would interpret \' and \\ within quotes, so they are
/// written separately.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char letter : text) {
    if (letter == '\'') {
      result += "'\\''";
    } else if (letter == '\\') {
      result += "'\\\\'";
    } else {
      result += letter == '\n' ? ' ' : letter;
    }
  }
  return result + "'";
}

bool is_shown(const DeclaredOption& option) {
  return !option.names().empty();
}

/// Returns lines "verb) text ;;" for the verbs with a non-empty text.
template <typename Text>
std::string cases_of(const std::vector<DeclaredVerb>& verbs, const Text& text_of) {
  std::string cases;
  for (const DeclaredVerb& verb : verbs) {
    if (const std::string text = text_of(verb); !text.empty())
      cases += cat("    ", quoted(verb.name), ") ", text, " ;;\n");
  }
  return cases;
}

std::string flags_of(const DeclaredVerb& verb) {
  std::vector<std::string> flags;
  for (const DeclaredOption& option : verb.options) {
    const auto names = option.names();
    flags.insert(flags.end(), names.begin(), names.end());
  }
  return join(flags, " ");
}

/// Returns the first words of verbs that have subverbs, as a pattern of the shell.
std::string groups_of(const std::vector<DeclaredVerb>& verbs) {
  std::vector<std::string> groups;
  for (const DeclaredVerb& verb : verbs) {
    if (!verb.name.empty() && !verb.subverbs.empty()) groups.push_back(verb.name);
  }
  return join(groups, "|");
}

/// Returns the bundled names of a positional argument, "e2lf-n4 ideal", or an empty string if it has none.
std::string bundled_arguments(const DeclaredVerb& verb) {
  for (const DeclaredOption& option : verb.options) {
    if (!option.argument.empty()) return join(option.bundled, " ");
  }
  return "";
}

std::string bash_values(const std::vector<DeclaredVerb>& verbs) {
  std::string cases;
  for (const DeclaredVerb& verb : verbs) {
    for (const DeclaredOption& option : verb.options) {
      if (!option.takes_value || !is_shown(option)) continue;
      if (option.choices.empty() && option.bundled.empty() && !option.is_number) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names()) patterns.push_back(quoted(verb.name + " " + name));
      const auto& words = option.bundled.empty() ? option.choices : option.bundled;
      cases += cat("    ", join(patterns, "|"), ") words=", quoted(join(words, " ")), "; is_value=1",
                   option.bundled.empty() ? "" : " files=-f", " ;;\n");
    }
  }
  return cases;
}

std::string bash_script(const std::vector<DeclaredVerb>& verbs) {
  return cat(R"(# Completion of e2lf for bash; made by `e2lf completion bash`.
_e2lf() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local verb= first=1 words= is_value= files=
  # "--model=NAME" comes as three words.
  if [ "$current" = "=" ]; then current=
  elif [ "$previous" = "=" ]; then previous=${COMP_WORDS[COMP_CWORD-2]}
  fi
  if ((COMP_CWORD > 1)); then verb=${COMP_WORDS[1]} first=2; fi
  case $verb in
    )",
             groups_of(verbs), R"() if ((COMP_CWORD > 2)); then verb+=" ${COMP_WORDS[2]}" first=3; fi ;;
  esac
  case "$verb $previous" in
)",
             bash_values(verbs), R"(  esac
  if [ -z "$is_value" ]; then
    case $verb in
)",
             cases_of(verbs,
                      [](const DeclaredVerb& verb) {
                        if (!verb.subverbs.empty()) {
                          return cat(
                              "if ((COMP_CWORD < first)) || [ -z \"$verb\" ] || ((COMP_CWORD == first)); then words=",
                              quoted(join(verb.subverbs, " ") + " --help"), "; fi");
                        }
                        const std::string flags = cat("words=", quoted(flags_of(verb)));
                        const std::string names = bundled_arguments(verb);
                        if (names.empty()) return flags;
                        return cat("if [[ $current == -* ]]; then ", flags, "; else words=", quoted(names),
                                   " is_value=1 files=-f; fi");
                      }),
             R"(    esac
  fi
  COMPREPLY=()
  if [ -n "$is_value" ] || [[ $current == -* ]] || ((COMP_CWORD < 2)); then
    mapfile -t COMPREPLY < <(compgen $files -W "$words" -- "$current")
    if [ -n "$files" ]; then compopt -o filenames 2>/dev/null; else compopt +o default 2>/dev/null; fi
    return
  fi
  case $verb in
    )",
             groups_of(verbs), R"()
      mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
      compopt +o default 2>/dev/null ;;
  esac
}
complete -o default -F _e2lf e2lf
)");
}

/// Escapes a text for a specification of zsh's _arguments, where brackets and colons have a meaning.
std::string zsh_text(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '[' || letter == ']' || letter == ':' || letter == '\\') result += '\\';
    result += letter;
  }
  return result;
}

std::string zsh_value(const DeclaredOption& option) {
  if (!option.takes_value) return "";
  if (!option.choices.empty()) return cat(":value:(", join(option.choices, " "), ")");
  if (!option.bundled.empty()) {
    return cat(":name:{_alternative \"names:bundled:(", join(option.bundled, " "), ")\" \"files:file:_files\"}");
  }
  return option.is_number ? ":number: " : ":file:_files";
}

std::string zsh_arguments(const DeclaredVerb& verb) {
  std::string text = "_arguments -s";
  for (const DeclaredOption& option : verb.options) {
    const std::vector<std::string> names = option.names();
    for (const std::string& name : names) {
      const std::string others = names.size() > 1 ? cat("(", join(names, " "), ")") : "";
      text += " " + quoted(cat(others, name, "[", zsh_text(option.help), "]", zsh_value(option)));
    }
  }
  for (const DeclaredOption& option : verb.options) {
    if (!option.argument.empty() && !option.bundled.empty()) return text + " " + quoted("*" + zsh_value(option));
  }
  return text + " '*:file:_files'";
}

std::string zsh_subverbs(const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs) {
  std::string text = "local -a verbs=(";
  for (const auto& [name, other] : subverbs_of(verb, verbs)) {
    text += " " + quoted(cat(name, ":", zsh_text(other->summary)));
  }
  return text + " ); _describe verb verbs";
}

std::string zsh_script(const std::vector<DeclaredVerb>& verbs) {
  return cat(R"(#compdef e2lf
# Completion of e2lf for zsh; made by `e2lf completion zsh`.
_e2lf() {
  local verb= first=1
  if ((CURRENT > 2)); then verb=${words[2]} first=2; fi
  case $verb in
    )",
             groups_of(verbs), R"() if ((CURRENT > 3)); then verb+=" ${words[3]}" first=3; fi ;;
  esac
  local key=$verb
  words=("$words[1]" "${(@)words[first+1,-1]}")
  ((CURRENT -= first - 1))
  case $key in
)",
             cases_of(verbs,
                      [&](const DeclaredVerb& verb) {
                        return verb.subverbs.empty() ? zsh_arguments(verb) : zsh_subverbs(verb, verbs);
                      }),
             R"(  esac
}
_e2lf "$@"
)");
}

std::string fish_option(const DeclaredVerb& verb, const DeclaredOption& option) {
  std::string text = cat("complete -c e2lf -n ", quoted("__e2lf_is " + verb.name));
  for (const std::string& name : option.short_names) text += " -s " + name.substr(1);
  for (const std::string& name : option.long_names) text += " -l " + name.substr(2);
  if (option.takes_value && !option.choices.empty()) text += cat(" -x -a ", quoted(join(option.choices, " ")));
  if (option.takes_value && option.choices.empty()) text += option.is_number ? " -x" : " -r -F";
  if (!option.bundled.empty()) text += " -a " + quoted(join(option.bundled, " "));
  return cat(text, " -d ", quoted(option.help), "\n");
}

std::string fish_script(const std::vector<DeclaredVerb>& verbs) {
  std::string text = R"(# Completion of e2lf for fish; made by `e2lf completion fish`.
# Whether the words so far begin with e2lf and these.
function __e2lf_is
  set -l words (commandline -opc)
  set -l last (math 1 + (count $argv))
  test (count $words) -ge $last; and test "$words[2..$last]" = "$argv"
end
# The same, and nothing behind them yet.
function __e2lf_ends_with
  set -l words (commandline -opc)
  test "$words[2..-1]" = "$argv"
end
)";
  for (const DeclaredVerb& verb : verbs) {
    for (const DeclaredOption& option : verb.options) {
      if (is_shown(option)) text += fish_option(verb, option);
      if (!option.argument.empty() && !option.bundled.empty()) {
        text += cat("complete -c e2lf -n ", quoted("__e2lf_ends_with " + verb.name), " -a ",
                    quoted(join(option.bundled, " ")), "\n");
      }
    }
    for (const auto& [name, other] : subverbs_of(verb, verbs)) {
      text += cat("complete -c e2lf -f -n ", quoted(cat("__e2lf_ends_with ", verb.name)), " -a ", name, " -d ",
                  quoted(other->summary), "\n");
    }
  }
  return text;
}

}  // namespace

Result<std::string> completion_script(const std::string& shell, const std::vector<DeclaredVerb>& verbs) {
  if (shell == "bash") return bash_script(verbs);
  if (shell == "zsh") return zsh_script(verbs);
  if (shell == "fish") return fish_script(verbs);
  return Error{ErrorCode::kInvalidValue, "completion is available for bash, zsh and fish; give one of them", shell};
}

}  // namespace e2lf::cli
