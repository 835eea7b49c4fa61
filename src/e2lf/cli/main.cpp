// SPDX-License-Identifier: MIT
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/version.h"

namespace {

struct VerbEntry {
  const char* name;
  const char* summary;
  int (*run)(const std::vector<std::string>& arguments);
};

constexpr VerbEntry kVerbs[] = {
    {"demo", "simulate a scene, reconstruct its light field, measure it", e2lf::cli::run_demo},
    {"info", "say what a file or folder is", e2lf::cli::run_info},
    {"convert", "convert between event formats, or between light-field formats", e2lf::cli::run_convert},
    {"accumulate", "recording -> event images per pattern cycle", e2lf::cli::run_accumulate},
    {"simulate", "light field -> event images or a recording", e2lf::cli::run_simulate},
    {"reconstruct", "event images or a recording -> light field", e2lf::cli::run_reconstruct},
    {"eval", "compare a reconstruction with the truth", e2lf::cli::run_eval},
    {"codes", "look at aperture patterns", e2lf::cli::run_codes},
    {"model", "look at and import model files", e2lf::cli::run_model},
    {"bench", "measure speed against the peers", e2lf::cli::run_bench},
};

void print_help() {
  std::printf("e2lf %s: light fields from the events of a coded-aperture camera\n\nusage: e2lf <verb> [flags]\n\n",
              e2lf::cli::kVersion);
  for (const VerbEntry& verb : kVerbs) std::printf("  %-12s %s\n", verb.name, verb.summary);
  std::printf("\ne2lf <verb> --help explains a verb and gives an example; e2lf version prints the version.\n");
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    print_help();
    return 2;
  }
  const std::string& name = arguments.front();
  if (name == "--help" || name == "-h" || name == "help") {
    print_help();
    return 0;
  }
  if (name == "--version" || name == "version") {
    std::printf("e2lf %s\n", e2lf::cli::kVersion);
    return 0;
  }
  std::vector<std::string> names;
  for (const VerbEntry& verb : kVerbs) {
    if (name == verb.name) return verb.run({arguments.begin() + 1, arguments.end()});
    names.emplace_back(verb.name);
  }
  std::fprintf(stderr, "e2lf: there is no verb \"%s\"; did you mean \"%s\"? See e2lf --help\n", name.c_str(),
               e2lf::nearest_word(name, names).c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "e2lf: internal error: %s; please report it with the command you ran\n", error.what());
    return 1;
  }
}
