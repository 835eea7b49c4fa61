// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/bundled_files.h"

#include <algorithm>

#include "e2lf/base/text.h"

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

std::vector<std::string> bundled_names(const BundledKind& kind) {
  std::vector<std::string> names;
  const auto folder = bundled_file(kind.folder);
  std::error_code error;
  if (!folder) return names;
  for (fs::directory_iterator entry(*folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == kind.extension) names.push_back(entry->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<fs::path> bundled_file_named(const BundledKind& kind, const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos) return std::nullopt;
  const std::string extension = name.ends_with(kind.extension) ? "" : kind.extension;
  return bundled_file(cat(kind.folder, "/", name, extension));
}

std::string shown_name(const BundledKind& kind, const fs::path& path) {
  return path == bundled_file_named(kind, path.stem().string()) ? path.stem().string() : path.string();
}

Result<fs::path> find_file_or_bundled(const BundledKind& kind, const std::string& name) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return fs::path(name);
  if (auto bundled = bundled_file_named(kind, name)) return std::move(*bundled);
  if (fs::exists(name, error)) return fs::path(name);
  const std::vector<std::string> names = bundled_names(kind);
  const std::string remedy =
      names.empty() ? "give one" : cat("give one, or a bundled ", kind.bundled, ": ", join(names));
  return Error{ErrorCode::kNotFound, cat("there is no such ", kind.any, "; ", remedy), name};
}

}  // namespace e2lf::cli
