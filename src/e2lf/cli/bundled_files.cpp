// SPDX-License-Identifier: MIT
#include "e2lf/cli/bundled_files.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

std::optional<fs::path> bundled_file(const std::string& path) {
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& folder : {binary.parent_path() / "../share/e2lf", fs::path(E2LF_SOURCE_TREE)}) {
    if (fs::exists(folder / path, error)) return (folder / path).lexically_normal();
  }
  return std::nullopt;
}

std::optional<fs::path> bundled_model() {
  return bundled_file("models/e2lf-n4.safetensors");
}

}  // namespace e2lf::cli
