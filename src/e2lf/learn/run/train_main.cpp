// SPDX-License-Identifier: MIT
// e2lf-train contains only the training verbs, for machines that have torch and little else.
#include <csignal>
#include <cstdio>
#include <getopt.h>
#include <string>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/files/file.h"
#include "e2lf/learn/run/commands.h"
#include "e2lf/terminal/progress_bar.h"

namespace {

void print_usage(std::FILE* where) {
  std::fputs(
      "usage: e2lf-train train CONFIG.json -o RUN [--set key=value]...\n       e2lf-train resume RUN [--set "
      "key=value]...\n       e2lf-train evaluate RUN SCENE... [--set key=value]...   (names in the run's packed "
      "data)\n       e2lf-train export RUN -o MODEL.safetensors [--overwrite]\n--quiet: do not show the "
      "progress\n",
      where);
}

int print_help() {
  print_usage(stdout);
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 ? 0 : 1;
}

int usage_error() {
  print_usage(stderr);
  return 2;
}

/// Warnings are printed even with --quiet.
void print_warnings(e2lf::LogLevel level, const std::string& message) {
  if (level != e2lf::LogLevel::kWarning) return;
  e2lf::hide_progress();
  std::fprintf(stderr, "e2lf-train: warning: %s\n", message.c_str());
}

/// Prints the path of a run's model, which one of several processes writes.
e2lf::Result<void> print_model(const e2lf::Result<std::filesystem::path>& model, bool quiet) {
  if (!model) return model.error();
  e2lf::hide_progress();
  if (!quiet && e2lf::is_present(*model)) std::printf("model in %s\n", model->c_str());
  return {};
}

/// Prints a report, or the error in its place.
e2lf::Result<void> print(const e2lf::Result<std::string>& report) {
  if (!report) return report.error();
  e2lf::hide_progress();
  std::fputs(report->c_str(), stdout);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names, overrides;
  std::string output;
  bool overwrite = false, quiet = false;
  const option options[] = {{"set", required_argument, nullptr, 's'},
                            {"overwrite", no_argument, nullptr, 'w'},
                            {"quiet", no_argument, nullptr, 'q'},
                            {"help", no_argument, nullptr, 'h'},
                            {nullptr, 0, nullptr, 0}};
  for (int key; (key = ::getopt_long(argc, argv, "ho:", options, nullptr)) != -1;) {
    switch (key) {
      case 's':
        overrides.emplace_back(optarg);
        break;
      case 'o':
        output = optarg;
        break;
      case 'w':
        overwrite = true;
        break;
      case 'q':
        quiet = true;
        break;
      case 'h':
        return print_help();
      default:
        return usage_error();
    }
  }
  names.assign(argv + optind, argv + argc);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of the size of files then fails, and its part is removed
  if (names.size() < 2) return usage_error();
  // The first signal ends training after the current step with a checkpoint; the other verbs have nothing to save.
  if (names[0] == "train" || names[0] == "resume") e2lf::stop_on_signals();
  const auto keep_going = [] { return !e2lf::stop_requested(); };
  e2lf::set_log_sink(print_warnings);
  e2lf::set_option_spelling([](const std::string& name) { return name == "overwrite" ? "--overwrite" : ""; });

  // An option that a verb does not have is refused.
  const bool is_export = names[0] == "export", has_output = is_export || names[0] == "train";
  if (has_output == output.empty() || (is_export ? !overrides.empty() : overwrite)) return usage_error();
  e2lf::ProgressBar bar(names[0], quiet);
  e2lf::Result<void> result;
  if (names[0] == "train" && names.size() == 2) {
    result = print_model(e2lf::learn::train(names[1], output, overrides, bar.callback(), keep_going), quiet);
  } else if (names[0] == "resume" && names.size() == 2) {
    result = print_model(e2lf::learn::resume(names[1], overrides, bar.callback(), keep_going), quiet);
  } else if (names[0] == "evaluate" && names.size() > 2) {
    result = print(e2lf::learn::evaluate_run(names[1], {names.begin() + 2, names.end()}, overrides));
  } else if (is_export && names.size() == 2) {
    result = e2lf::learn::export_run(names[1], output, overwrite);
  } else {
    return usage_error();
  }
  if (result && (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)) {
    result = e2lf::Error{e2lf::ErrorCode::kIo, "cannot write to standard output; check where it goes", ""};
  }
  if (result) return 0;
  e2lf::hide_progress();
  std::fprintf(stderr, "e2lf-train: %s: %s\n", names[0].c_str(), result.error().text().c_str());
  return e2lf::stop_requested() ? 128 + e2lf::stop_signal() : 1;
}
