// SPDX-License-Identifier: MIT
// e2lf-train: the training verbs alone, for machines that have torch and little else.
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include "e2lf/learn/commands.h"

namespace {

volatile std::sig_atomic_t g_stop = 0;

int usage() {
  std::fputs(
      "usage: e2lf-train train CONFIG.json -o RUN [--set key=value]...\n"
      "       e2lf-train resume RUN [--set key=value]...\n"
      "       e2lf-train evaluate RUN SCENE... [--set key=value]...\n"
      "       e2lf-train export RUN -o MODEL.safetensors\n",
      stderr);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names, overrides;
  std::string output;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool takes_value = argument == "-o" || argument == "--set";
    if (takes_value && i + 1 == argc) return usage();
    if (argument == "-o") {
      output = argv[++i];
    } else if (argument == "--set") {
      overrides.emplace_back(argv[++i]);
    } else {
      names.push_back(argument);
    }
  }
  if (names.size() < 2) return usage();
  std::signal(SIGINT, [](int) { g_stop = 1; });
  std::signal(SIGTERM, [](int) { g_stop = 1; });
  const auto keep_going = [] { return g_stop == 0; };

  e2lf::ProgressBar bar(names[0]);
  e2lf::Result<void> result;
  if (names[0] == "train" && names.size() == 2 && !output.empty()) {
    result = e2lf::learn::train(names[1], output, overrides, bar.callback(), keep_going);
  } else if (names[0] == "resume" && names.size() == 2) {
    result = e2lf::learn::resume(names[1], overrides, bar.callback(), keep_going);
  } else if (names[0] == "evaluate" && names.size() > 2) {
    const auto report = e2lf::learn::evaluate_run(names[1], {names.begin() + 2, names.end()}, overrides);
    if (report) std::fputs(report->c_str(), stdout);
    if (!report) result = report.error();
  } else if (names[0] == "export" && names.size() == 2 && !output.empty()) {
    result = e2lf::learn::export_run(names[1], output);
  } else {
    return usage();
  }
  if (result) return 0;
  std::fprintf(stderr, "e2lf-train: %s: %s\n", names[0].c_str(), result.error().text().c_str());
  return 1;
}
