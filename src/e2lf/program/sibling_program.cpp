// SPDX-License-Identifier: MIT
#include "e2lf/program/sibling_program.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/engine/engine.h"

namespace e2lf::program {
namespace fs = std::filesystem;
namespace {

constexpr const char* kWithTorch = "e2lf-torch";

fs::path self() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error);
}

}  // namespace

std::vector<std::string> own_arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(file, argument, '\0');) arguments.push_back(argument);
  if (!arguments.empty()) arguments.erase(arguments.begin());
  return arguments;
}

Error continue_as(const std::string& name, std::vector<std::string> arguments, const std::string& remedy) {
  const std::string program = (self().parent_path() / name).string();
  std::vector<char*> pointers = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  return fail(ErrorCode::kMissingDependency, program, "cannot start it (", std::strerror(errno), "); ", remedy);
}

Result<void> require_device(const std::string& device) {
  if (engine::is_known_device(device) || self().filename() == kWithTorch) return engine::check_device(device);
  return continue_as(kWithTorch, own_arguments(),
                     "the device cpu needs no torch; for others, install libtorch-dev or a torch with CUDA, configure "
                     "again and rebuild");
}

}  // namespace e2lf::program
