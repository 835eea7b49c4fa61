// SPDX-License-Identifier: MIT
#include "e2lf/cli/program.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>

namespace e2lf::cli {
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
  try {
    return check_standard_output(run({argv + 1, argv + argc}));
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: there is not enough memory; end other programs, or give a part of the input\n", name);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error: %s; please report it with the command you ran\n", name, error.what());
  }
  return 1;
}

}  // namespace e2lf::cli
