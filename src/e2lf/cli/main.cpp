// SPDX-License-Identifier: MIT
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "e2lf/cli/verb.h"
#include "e2lf/cli/version.h"

namespace {

using namespace e2lf::cli;  // the list of verbs

const std::vector<VerbEntry>& verbs() {
  static const std::vector<VerbEntry> list = {
      {"demo", "simulate a scene, reconstruct its light field, measure it", run_demo},
      {"info", "say what a file or folder is", run_info},
      {"convert", "convert between event formats, or between light-field formats", run_convert},
      {"accumulate", "recording -> event images per pattern cycle", run_accumulate},
      {"simulate", "light field -> event images or a recording", run_simulate},
      {"reconstruct", "event images or a recording -> light field", run_reconstruct},
      {"video", "a recording -> grey frames, by a network or plainly", run_video},
      {"calibrate", "event images of still scenes -> the constants of a camera", run_calibrate},
      {"eval", "compare a reconstruction with the truth", run_eval},
      {"view", "look at light fields, events, recordings and models in a browser", run_view},
      {"pack", "light fields and photographs -> one file to train on", run_pack},
      {"train", "learn aperture patterns and a network together", run_train},
      {"resume", "continue a training run", run_resume},
      {"codes", "look at aperture patterns", run_codes},
      {"model", "look at and import model files", run_model},
      {"bench", "measure speed against the peers", run_bench},
  };
  return list;
}

/// A result that did not reach its reader is a failure.
int check_standard_output(int code) {
  const bool is_written = std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (is_written) return code;
  std::fprintf(stderr, "e2lf: cannot write to standard output (%s); free some disk space or check where it goes\n",
               std::strerror(errno));
  return code == 0 ? 1 : code;
}

int run(const std::vector<std::string>& arguments) {
  if (!arguments.empty() && (arguments.front() == "--version" || arguments.front() == "version")) {
    std::printf("e2lf %s\n", kVersion);
    return 0;
  }
  return run_subverb("", verbs(), arguments);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return check_standard_output(run({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "e2lf: internal error: %s; please report it with the command you ran\n", error.what());
    return 1;
  }
}
