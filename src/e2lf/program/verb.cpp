// SPDX-License-Identifier: MIT
#include "e2lf/program/verb.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <set>
#include <unistd.h>
#include <utility>

#include "e2lf/base/isa.h"
#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/info/version.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::program {
namespace fs = std::filesystem;
namespace {

const char* the_name = "e2lf";

/// If the output could not be written, the run has failed.
int check_standard_output(int code) {
  const bool is_written = std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (is_written) return code;
  std::fprintf(stderr, "%s: cannot write to standard output (%s); free some disk space or check where it goes\n",
               the_name, std::strerror(errno));
  return code == 0 ? 1 : code;
}

}  // namespace

const char* program_name() {
  return the_name;
}

int run_program(const char* name, int argc, char** argv,
                const std::function<int(const std::vector<std::string>& arguments)>& run) {
  the_name = name;
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of the size of files then fails, and its part is removed
  try {
    return check_standard_output(run({argv + 1, argv + argc}));
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: there is not enough memory; end other programs, or give a part of the input\n", name);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error: %s; please report it with the command you ran\n", name, error.what());
  }
  return 1;
}

namespace {

void print_log(LogLevel level, const std::string& message) {
  hide_progress();
  const bool is_warning = level == LogLevel::kWarning, is_coloured = isatty(STDERR_FILENO) != 0;
  std::fprintf(stderr, "%s: %s%s\n", program_name(),
               !is_warning   ? ""
               : is_coloured ? "\x1b[1;33mwarning:\x1b[0m "
                             : "warning: ",
               printable(without_workspaces(message)).c_str());
}

/// Returns the names of all long flags, without "--".
std::vector<std::string> long_flags(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

/// Returns a message with the missing argument, its meaning, and an example of a complete command.
std::optional<std::string> missing_argument(const CLI::App& app, const std::string& example) {
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_required() || option->count() > 0) continue;
    const std::string name = option->get_positional() ? "an argument" : option->get_name();
    return cat(name, " is missing: ", option->get_description(), "; for example `", example, "`");
  }
  return std::nullopt;
}

/// Returns a message about an argument that is the name of a file but looks like an option.
std::optional<std::string> dashed_file(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument.size() < 2 || argument[0] != '-' || !is_present(argument)) continue;
    return cat(argument, " is taken for an option; write ./", argument, " for the file");
  }
  return std::nullopt;
}

/// Returns a message about the first argument that looks like a long flag but is none.
std::optional<std::string> unknown_argument(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (auto file = dashed_file(arguments)) return file;
  for (const std::string& argument : arguments) {
    const std::string flag = argument.substr(0, argument.find('='));
    if (!flag.starts_with("--") || app.get_option_no_throw(flag) != nullptr) continue;
    return cat("there is no option ", flag, "; ", suggestion(flag, flags_of(app), ""));
  }
  return std::nullopt;
}

/// Finds only --config and --set, whose content may supply what the rest of the command line lacks.
void find_config(std::vector<std::string> arguments, std::string& config, std::vector<std::string>& overrides) {
  CLI::App app;
  app.set_help_flag("");
  app.allow_extras();
  app.add_option("--config", config)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  app.add_option("--set", overrides)->allow_extra_args(false);
  std::ranges::reverse(arguments);  // CLI11 takes its vector from the back
  app.parse(arguments);
}

/// Returns "--sensor-width" for "sensor_width".
std::string long_flag(std::string name) {
  std::ranges::replace(name, '_', '-');
  return "--" + name;
}

/// Options that do not affect the result of a run; they are not taken over from an earlier one.
constexpr std::array kNotRepeated = {"json", "quiet", "overwrite", "report"};

/// Removes the key of an option, by whichever of its names.
void remove_option(const CLI::Option& option, Json& config) {
  for (std::string name : option.get_lnames()) {
    config.erase(name);
    std::ranges::replace(name, '-', '_');
    config.erase(name);
  }
}

/// Returns whether an option changes more than where the result is stored and what is printed.
bool changes_result(const CLI::Option& option) {
  static const std::set<std::string> kOthers = {"output", "threads", "config", "set"};
  return std::ranges::none_of(option.get_lnames(), [](const std::string& name) {
    return kOthers.contains(name) || std::ranges::find(kNotRepeated, name) != kNotRepeated.end();
  });
}

}  // namespace

Result<std::vector<std::string>> flags_from_config(const Json& config, const CLI::App& app,
                                                   const std::string& location) {
  if (!config.is_object())
    return fail(ErrorCode::kFormat, location, "the configuration is not an object; write { ... }");
  std::vector<std::string> flags;
  for (const auto& [key, value] : config.items()) {
    const std::string flag = long_flag(key);
    if (app.get_option_no_throw(flag) == nullptr) {
      return fail(ErrorCode::kInvalidValue, location, "unknown key \"", key, "\"; ",
                  suggestion(flag.substr(2), long_flags(app)));
    }
    for (const Json& one : value.is_array() ? value : Json::array({value})) {
      if (one.is_boolean()) {
        if (one.get<bool>()) flags.push_back(flag);
      } else {
        flags.push_back(flag + "=" + (one.is_string() ? one.get<std::string>() : json_line(one)));
      }
    }
  }
  return flags;
}

namespace {

std::string list_of(const std::string& command, const std::vector<VerbEntry>& entries) {
  std::string text =
      cat(program_name(), " ", info::kVersion,
          ": light fields from the events of a coded-aperture camera\n\nusage: ", command, " <verb> [flags]\n\n");
  for (const VerbEntry& entry : entries) {
    std::string name = entry.name;
    name.resize(std::max<size_t>(name.size(), 12), ' ');
    text += cat("  ", name, " ", entry.summary, "\n");
  }
  return text +
         cat("\n", command, " <verb> --help explains a verb and gives an example, --help-all lists all its options.\n");
}

}  // namespace

int run_subverb(const std::string& prefix, const std::vector<VerbEntry>& entries,
                const std::vector<std::string>& arguments) {
  std::vector<std::string> names;
  for (const VerbEntry& entry : entries) names.emplace_back(entry.name);
  if (is_completing() && arguments.size() < 2) {
    names.emplace_back("--help");
    print_candidates(names, arguments.empty() ? "" : arguments.front());
    return 0;
  }
  const std::string command = cat(program_name(), prefix.empty() ? "" : " ", prefix);
  if (arguments.empty()) {
    std::cerr << list_of(command, entries);
    return 2;
  }
  const std::string& name = arguments.front();
  if (name == "--help" || name == "--help-all" || name == "-h" || name == "help") {
    std::cout << list_of(command, entries);
    return 0;
  }
  for (const VerbEntry& entry : entries) {
    if (name == entry.name) return entry.run({arguments.begin() + 1, arguments.end()});
  }
  std::cerr << program_name() << (prefix.empty() ? "" : ": " + prefix) << ": there is no verb \"" << name << "\"; "
            << suggestion(name, names) << " (see `" << command << " --help`)\n";
  return 2;
}

Verb::Verb(std::string name, const std::string& summary, const std::string& example)
    : name_(std::move(name)), example_(example), app_(summary, cat(program_name(), " ", name_)) {
  app_.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  app_.footer("Example:\n  " + example);
  app_.set_help_flag("-h,--help", "print the usual options; --help=GROUP prints those of a group");
  app_.set_help_all_flag("--help-all", "print all options");
  app_.add_flag("--json", common_.json, "print the result as JSON");
  app_.add_flag("--quiet", common_.quiet, "print nothing but warnings and errors");
  app_.add_flag("--overwrite", common_.overwrite, "replace existing output");
  const OptionGroup group(app_, kRunOptions);
  app_.add_option(
      "--config", config_,
      "JSON file whose keys are the names of long flags, or an earlier result or its run.json, to repeat its run");
  app_.add_option("--set", overrides_, "set one key of the configuration: key=value (repeatable)")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  app_.add_option("--threads", common_.threads, "number of threads; 0 = all cores")->check(whole_number(0, 1024));
  app_.add_option("--seed", common_.seed, "seed of all random numbers")->capture_default_str();
}

void Verb::keep_overrides() {
  keeps_overrides_ = true;
  for (const char* flag : {"--config", "--seed", "--json", "--overwrite"}) {
    app_.remove_option(app_.get_option(flag));
  }
}

int Verb::usage_error(const std::string& message) const {
  std::fprintf(stderr, "%s: %s: %s; see %s %s --help\n", program_name(), name_.c_str(), message.c_str(), program_name(),
               name_.c_str());
  return 2;
}

/// Prints the help that --help or --help=GROUP asks for.
int Verb::print_help() const {
  const std::string word = app_.get_help_ptr()->results().back();
  if (word == "true") {
    std::cout << short_help(app_);
    return 0;
  }
  const auto text = group_help(app_, word);
  if (!text) {
    return usage_error(cat("there is no group of options \"", word, "\"; known are ", join(help_groups(app_))));
  }
  std::cout << *text;
  return 0;
}

/// Reads the keys and values of --config: those of the file, or the options of the run that it records.
Result<Json> Verb::read_config() {
  // The name of a result denotes its record.
  if (is_folder(config_)) config_ = (fs::path(config_) / "run.json").string();
  if (const fs::path record = record_path_beside(config_); is_present(record)) config_ = record.string();
  E2LF_ASSIGN_OR_RETURN(Json config, read_json(config_));
  if (config.is_object() && config.contains("written_by") && !config.contains("verb")) {
    return fail(ErrorCode::kInvalidValue, config_,
                "this is the record of a part of a run, such as one cycle; give the folder above it");
  }
  if (!config.is_object() || !config.contains("verb") || !config.contains("options")) return config;
  if (config["verb"] != name_) {
    return fail(ErrorCode::kInvalidValue, config_, "this is the record of a run of another verb (",
                json_line(config["verb"]), "); give one of ", name_);
  }
  for (const char* name : kNotRepeated) config["options"].erase(name);
  resolve_recorded_paths(config, app_);
  earlier_run_ = std::move(config);
  return earlier_run_["options"];
}

/// Returns the options that arguments name. If an argument is missing or wrong, parsing them with the configured ones
/// tells.
std::vector<const CLI::Option*> Verb::typed_options(std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);
  try {
    app_.parse(arguments);
  } catch (const CLI::ParseError&) {
  }
  return std::as_const(app_).get_options([](const CLI::Option* option) { return option->count() > 0; });
}

/// Returns the flags of --config and of every --set, without those of options that the arguments name or exclude. What
/// an earlier run determined by itself is determined again if more is changed than where its result is stored.
Result<std::vector<std::string>> Verb::configured_flags(const std::vector<std::string>& arguments) {
  if (config_.empty() && overrides_.empty()) return std::vector<std::string>();
  Json config = Json::object();
  if (!config_.empty()) {
    E2LF_ASSIGN_OR_RETURN(config, read_config());
  }
  const std::vector<const CLI::Option*> typed = typed_options(arguments);
  const bool is_changed =
      !overrides_.empty() || std::ranges::any_of(typed, [](const auto* option) { return changes_result(*option); });
  if (is_changed && earlier_run_.contains("determined")) {
    for (const Json& name : earlier_run_["determined"]) {
      if (name.is_string()) config.erase(name.get<std::string>());
    }
  }
  for (const std::string& assignment : overrides_) E2LF_RETURN_IF_ERROR(apply_override(config, assignment));
  for (const CLI::Option* option : typed) {
    remove_option(*option, config);
    for (const CLI::Option* excluded : option->get_excludes()) remove_option(*excluded, config);
  }
  return flags_from_config(config, app_, config_.empty() ? "--set" : config_);
}

std::vector<const CLI::Option*> Verb::changed_options(const std::vector<std::string>& options) const {
  return app_.get_options([&](const CLI::Option* option) {
    const bool is_named = std::ranges::any_of(
        options, [&](const std::string& name) { return name == option->get_group() || name == option->get_name(); });
    // A run that is repeated from its record also repeats the defaults.
    return is_named && option->count() > 0 && join(option->results()) != option->get_default_str();
  });
}

Result<void> Verb::refuse_options(const std::vector<std::string>& options, const std::string& what) const {
  const auto refused = changed_options(options);
  if (refused.empty()) return {};
  return fail(ErrorCode::kInvalidValue, refused.front()->get_name(), "has no effect on ", what, "; omit it");
}

std::string Verb::text_of_options(const std::vector<std::string>& options) const {
  std::string text;
  for (const CLI::Option* option : changed_options(options)) {
    text += cat(" ", option->get_name());
    if (option->get_expected_max() == 0) continue;  // flag
    for (const std::string& value : option->results()) text += cat(" ", shell_word(value));
  }
  return text;
}

int Verb::run(std::vector<std::string> arguments, const std::function<Result<void>()>& work) {
  if (is_completing()) {
    print_candidates(app_, std::move(arguments));
    return 0;
  }
  const auto parse = [this](std::vector<std::string> list) {
    std::ranges::reverse(list);  // CLI11 takes its vector from the back
    app_.parse(list);
  };
  check_numbers(app_);
  try {
    if (!keeps_overrides_) {
      find_config(arguments, config_, overrides_);
      const auto flags = configured_flags(arguments);
      if (!flags) return usage_error(flags.error().text());
      arguments.insert(arguments.begin(), flags->begin(), flags->end());
    }
    parse(arguments);
  } catch (const CLI::CallForHelp&) {
    return print_help();
  } catch (const CLI::CallForAllHelp&) {
    std::cout << whole_help(app_);
    return 0;
  } catch (const CLI::FileError& error) {
    std::fprintf(stderr, "%s: %s: %s\n", program_name(), name_.c_str(), error.what());
    return 1;
  } catch (const CLI::ExtrasError& error) {
    return usage_error(unknown_argument(app_, arguments).value_or(error.what()));
  } catch (const CLI::RequiredError& error) {
    if (const auto file = dashed_file(arguments)) return usage_error(*file);
    return usage_error(missing_argument(app_, example_).value_or(error.what()));
  } catch (const CLI::ParseError& error) {
    std::string message = error.what();
    while (!message.empty() && (message.back() == '\n' || message.back() == '.')) message.pop_back();
    return usage_error(message);
  }
  if (const auto capped = apply_isa_cap(); !capped) return usage_error(capped.error().text());
  set_num_threads(common_.threads);
  const LogSink before = set_log_sink([this](LogLevel level, const std::string& message) {
    if (!common_.quiet || level == LogLevel::kWarning) print_log(level, message);
  });
  const OptionSpelling spelling_before = set_option_spelling([this](const std::string& name) {
    const std::string flag = long_flag(name);
    return app_.get_option_no_throw(flag) == nullptr ? "" : flag;
  });
  if (stops_gently_) stop_on_signals();
  const int code = exit_code(work());
  set_option_spelling(spelling_before);
  set_log_sink(before);
  return code;
}

int Verb::exit_code(const Result<void>& result) const {
  if (!result) {
    const Error& error = result.error();
    const std::string text = without_workspaces(error.text());
    std::fprintf(stderr, "%s: %s: %s\n", program_name(), name_.c_str(), printable(text).c_str());
  }
  if (!stop_requested() && result && !failed_input_.empty()) {
    std::fprintf(stderr, "%s: %s: the input failed: %s; the data before that were written\n", program_name(),
                 name_.c_str(), printable(failed_input_).c_str());
    return 3;
  }
  if (!stop_requested()) return result ? 0 : 1;
  std::fprintf(stderr, "%s: %s: ended by %s; %s\n", program_name(), name_.c_str(),
               stop_signal() == SIGINT ? "SIGINT" : "SIGTERM",
               result ? "everything that was complete was written" : "nothing was complete");
  return 128 + stop_signal();
}

namespace {

/// Returns whether an option names what the verb writes.
bool is_output(const CLI::Option& option) {
  constexpr std::array kOutputs = {"output", "last", "export", "report"};
  return std::ranges::any_of(option.get_lnames(), [&](const std::string& name) {
    return std::ranges::find(kOutputs, name) != kOutputs.end();
  });
}

/// Returns the path that a value of an option denotes, or an empty one if the option names no files.
fs::path path_of_value(const std::string& type, const std::string& value) {
  if (type == kPathType) return value;
  const bool is_camera = type == kCameraType;
  if (!is_camera && type != kModelType && type != kCodesType && type != kThingType) return {};
  return find_file_or_bundled(is_camera ? kBundledCameras : kBundledModels, value).value_or(value);
}

}  // namespace

std::vector<fs::path> Verb::named_inputs() const {
  std::vector<fs::path> inputs;
  for (const CLI::Option* option : app_.get_options()) {
    if (is_output(*option)) continue;
    for (const std::string& value : option->results()) {
      fs::path path = path_of_value(value_type(*option), value);
      if (!path.empty()) inputs.push_back(std::move(path));
    }
  }
  // The record of a run may be replaced when the run is repeated.
  if (earlier_run_.is_null() && !config_.empty()) inputs.emplace_back(config_);
  return inputs;
}

Json Verb::resolved_options() const {
  Json options = Json::object();
  for (const CLI::Option* option : app_.get_options()) {
    if (option->get_lnames().empty() || option == app_.get_help_ptr() || option == app_.get_help_all_ptr()) continue;
    const std::string name = option->get_lnames().front();
    // Their keys are already among the others.
    if (name == "config" || (name == "set" && !keeps_overrides_)) continue;
    if (option->count() > 0) {
      const int most = option->get_items_expected_max();
      options[name] = most == 0 ? Json(true) : most == 1 ? Json(option->results().back()) : Json(option->results());
    } else if (!option->get_default_str().empty()) {
      options[name] = option->get_default_str();
    }
  }
  return options;
}

Result<void> repeat_until_stopped(const std::function<Result<bool>(size_t number)>& step) {
  for (size_t number = 0; number == 0 || !stop_requested(); ++number) {
    const Result<bool> more = step(number);
    if (!more && more.error().code == ErrorCode::kCancelled && number > 0) break;
    if (!more || !*more) return more ? Result<void>() : more.error();
  }
  return {};
}

void print_result(const CommonOptions& common, const Json& json, const std::string& text, std::FILE* to) {
  if (!common.json && common.quiet) return;
  std::fputs(common.json ? json_text(json).c_str() : text.c_str(), to);
}

std::string shell_word(const std::string& word) {
  const bool is_plain = word.find_first_not_of(
                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                            "_@%+=:,./-") == std::string::npos;
  if (is_plain && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string shell_word(const fs::path& path) {
  const std::string name = path.string();
  return shell_word(name.size() > 1 && name[0] == '-' ? "./" + name : name);
}

void print_next_step(const std::string& command, const CommonOptions& common) {
  if (common.json || common.quiet) return;
  std::printf("next: %s\n", command.c_str());
}

}  // namespace e2lf::program
