// SPDX-License-Identifier: MIT
#include "e2lf/cli/verbs/trainer_program.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <unistd.h>

#include "e2lf/base/text.h"

namespace e2lf::cli {

Result<void> become_trainer(std::vector<std::string> arguments, int threads) {
  // Read by torch and its BLAS; without it, the trainer uses all cores.
  if (threads > 0) ::setenv("OMP_NUM_THREADS", std::to_string(threads).c_str(), 1);
  std::error_code status;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", status);
  const std::string program = (self.parent_path() / "e2lf-train").string();
  std::vector<char*> pointers = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  return Error{
      ErrorCode::kMissingDependency,
      cat("cannot start it (", std::strerror(errno),
          "); `./run train` and `./run resume` build it, or install libtorch-dev, configure again and rebuild"),
      program};
}

}  // namespace e2lf::cli
