// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/files/options.h"
#include "e2lf/program/options.h"

namespace e2lf::program {

/// Returns the name of the running program, which its messages start with: "e2lf", unless run_program() received
/// another.
[[nodiscard]] const char* program_name();

/// Implements main(): calls `run` with the arguments after the program's name, checks that everything printed was
/// written successfully, and converts exceptions to a message. Returns the exit code of the process.
int run_program(const char* name, int argc, char** argv,
                const std::function<int(const std::vector<std::string>& arguments)>& run);

/// Resolves the relative paths of a run's record against the folder in which the run was started ("folder" of the
/// record), so that the run can be repeated from any folder: those of the inputs, and those of the options that `app`
/// declares as paths.
void resolve_recorded_paths(Json& record, const CLI::App& app);

/// The flags that every verb has.
struct CommonOptions {
  int threads = 0;  ///< 0 = all cores
  uint64_t seed = 1;
  bool json = false;
  bool quiet = false;
  bool overwrite = false;
};

/// A verb of the command line. It declares its flags on a CLI11 app and then does its work in a function that returns a
/// Result. run() adds the common flags, --config FILE.json and --set key=value (the keys are the names of the long
/// flags), limits the number of threads, and reports usage errors. --config also accepts the run.json of an earlier run
/// of the verb, which is then repeated.
///
///   Verb verb("eval", "compare light fields", "e2lf eval TRUTH RECON --json");
///   verb.app().add_option("truth", truth, "the true light field")->required();
///   return verb.run(arguments, [&]() -> Result<void> { ... });
class Verb {
 public:
  Verb(std::string name, const std::string& summary, const std::string& example);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] CLI::App& app() { return app_; }
  [[nodiscard]] const CommonOptions& common() const { return common_; }

  /// For a verb with a configuration of its own: leaves the assignments of --set to the verb instead of reading them as
  /// flags, and removes the common flags that the configuration replaces (--config, --seed) or that do not apply
  /// (--json, --overwrite).
  void keep_overrides();
  [[nodiscard]] const std::vector<std::string>& overrides() const { return overrides_; }

  /// For a verb whose work checks stop_requested(): the first SIGINT or SIGTERM ends the work early and keeps what is
  /// complete. A second signal, or the first one of any other verb, ends the process at once.
  void stop_gently() { stops_gently_ = true; }

  /// Notes the failure that ended live input early (LiveBacklog::failure, empty if there was none). If the work
  /// succeeds, run() then reports the failure and returns 3, because the result contains only what came before it.
  void set_failed_input(const std::string& failure) const { failed_input_ = failure; }

  /// Fails with kInvalidValue if one of these options, which are names or help groups, differs from its default
  /// although it has no effect, because the input is `what` ("a light field").
  [[nodiscard]] Result<void> refuse_options(const std::vector<std::string>& options, const std::string& what) const;

  /// Returns those of these options, which are names or help groups, that differ from their defaults, as they are typed
  /// (" --source bursts"), for the next command.
  [[nodiscard]] std::string text_of_options(const std::vector<std::string>& options) const;

  /// Parses the arguments, runs `work`, and prints its error as "e2lf: <verb>: <what went wrong>; <what to do>".
  /// Returns the exit code of the process: 0 success, 1 failure, 2 usage error, 3 success with live input that
  /// failed early, 130 and 143 ended by SIGINT and SIGTERM.
  int run(std::vector<std::string> arguments, const std::function<Result<void>()>& work);

  /// Returns the record of the run that --config repeats, or null.
  [[nodiscard]] const Json& earlier_run() const { return earlier_run_; }

  /// Returns the files and folders that options and arguments name, other than those that the verb writes, with the
  /// paths of bundled files: no output may replace them.
  [[nodiscard]] std::vector<std::filesystem::path> named_inputs() const;

  /// Returns every flag with its value after parsing, for run.json.
  [[nodiscard]] Json resolved_options() const;

 private:
  int usage_error(const std::string& message) const;
  int print_help() const;
  [[nodiscard]] int exit_code(const Result<void>& result) const;
  [[nodiscard]] Result<Json> read_config();
  [[nodiscard]] std::vector<const CLI::Option*> changed_options(const std::vector<std::string>& options) const;
  [[nodiscard]] std::vector<const CLI::Option*> typed_options(std::vector<std::string> arguments);
  [[nodiscard]] Result<std::vector<std::string>> configured_flags(const std::vector<std::string>& arguments);
  std::string name_, example_;
  CLI::App app_;
  CommonOptions common_;
  std::string config_;
  Json earlier_run_;
  std::vector<std::string> overrides_;
  mutable std::string failed_input_;
  bool keeps_overrides_ = false, stops_gently_ = false;
};

/// Converts a configuration object to flags: {"tau": 0.3, "overwrite": true} -> {"--tau=0.3", "--overwrite"}. Keys may
/// use '_' for '-'. Fails with kInvalidValue if a key is not a flag of `app`, suggesting the nearest one.
[[nodiscard]] Result<std::vector<std::string>> flags_from_config(const Json& config, const CLI::App& app,
                                                                 const std::string& location);

/// A verb or subverb: its name, a summary in a few words, and its function.
struct VerbEntry {
  const char* name;
  const char* summary;
  int (*run)(const std::vector<std::string>& arguments);
};

/// Runs the entry that the first argument names. Prints the list of entries for --help, and also, with exit code 2, if
/// the name is missing or unknown. `prefix` are the words before the name on the command line ("model", or "" for the
/// verbs themselves).
int run_subverb(const std::string& prefix, const std::vector<VerbEntry>& entries,
                const std::vector<std::string>& arguments);

/// Calls `step` with 0, 1, 2, ... until it returns false. Once a step is complete, a stop that is requested ends the
/// calls without an error, also during a step.
[[nodiscard]] Result<void> repeat_until_stopped(const std::function<Result<bool>(size_t number)>& step);

/// Prints the result of a run: `json` with --json, or else `text`, unless with --quiet.
void print_result(const CommonOptions& common, const Json& json, const std::string& text, std::FILE* to = stdout);

/// Returns a word as a shell requires it: quoted if it contains more than letters, digits and the common characters of
/// paths. A path that begins with - is written so that it is not taken for an option.
[[nodiscard]] std::string shell_word(const std::string& word);
[[nodiscard]] std::string shell_word(const std::filesystem::path& path);

/// Prints a command that uses the result, "next: e2lf view out", as the last line of a run. Prints nothing with --quiet
/// or --json.
void print_next_step(const std::string& command, const CommonOptions& common);

}  // namespace e2lf::program
