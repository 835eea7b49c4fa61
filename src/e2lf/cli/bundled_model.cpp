// SPDX-License-Identifier: MIT
#include "e2lf/cli/bundled_model.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

std::optional<fs::path> bundled_model() {
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& folder : {binary.parent_path() / "../share/e2lf/models", fs::path(E2LF_SOURCE_MODELS)}) {
    const fs::path path = folder / "e2lf-n4.safetensors";
    if (fs::exists(path, error)) return path.lexically_normal();
  }
  return std::nullopt;
}

}  // namespace e2lf::cli
