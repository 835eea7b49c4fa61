// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace e2lf::cli {

/// Returns the name of the running program, which its messages start with: "e2lf", unless run_program() received
/// another.
[[nodiscard]] const char* program_name();

/// Implements main(): calls `run` with the arguments after the program's name, checks that everything printed was
/// written successfully, and converts exceptions to a message. Returns the exit code of the process.
int run_program(const char* name, int argc, char** argv,
                const std::function<int(const std::vector<std::string>& arguments)>& run);

}  // namespace e2lf::cli
