// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace e2lf::cli {

/// Returns the name of the running program, which begins its messages: "e2lf" unless run_program() was given another.
[[nodiscard]] const char* program_name();

/// Runs the body of main(): calls `run` with the arguments behind the program's name, checks that what was printed
/// reached the reader, and turns exceptions into a message. Returns the exit code of the process.
int run_program(const char* name, int argc, char** argv,
                const std::function<int(const std::vector<std::string>& arguments)>& run);

}  // namespace e2lf::cli
