// SPDX-License-Identifier: MIT
#include "e2lf/files/bundled_files.h"

#include <algorithm>
#include <cstdlib>
#include <dlfcn.h>
#include <mutex>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

/// Returns the path of the running program, or of the shared object that contains this code, such as the Python module.
fs::path find_own_file() {
  static const char here = 0;
  Dl_info about{};
  std::error_code error;
  const fs::path loaded = ::dladdr(&here, &about) != 0 && about.dli_fname != nullptr ? about.dli_fname : "";
  return loaded.filename().string().find(".so") != std::string::npos ? fs::canonical(loaded, error)
                                                                     : fs::read_symlink("/proc/self/exe", error);
}

/// Returns the folders share/e2lf above this program or library, nearest first.
std::vector<fs::path> find_folders_above() {
  std::error_code error;
  std::vector<fs::path> folders;
  for (fs::path folder = find_own_file().parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    // In a build folder it is a link to the sources.
    if (const fs::path share = fs::canonical(folder / "share/e2lf", error); !error) folders.push_back(share);
  }
  return folders;
}

/// The folders that the program added. Initialised on first use, which is before main().
struct AddedFolders {
  std::mutex mutex;
  std::vector<fs::path> folders;
};

AddedFolders& added() {
  static AddedFolders instance;
  return instance;
}

/// Returns the folders that may contain bundled files, nearest first.
std::vector<fs::path> data_folders() {
  static const std::vector<fs::path> above = find_folders_above();
  std::vector<fs::path> folders = above;
  const std::scoped_lock lock(added().mutex);
  folders.insert(folders.end(), added().folders.begin(), added().folders.end());
  folders.emplace_back(E2LF_INSTALLED_DATA);
  return folders;
}

/// Returns the place of a bundled file if E2LF_MODELS names the folder of models; cameras are then beside this folder.
fs::path place_of_caller(const std::string& path) {
  const char* models = std::getenv("E2LF_MODELS");
  if (models == nullptr || *models == '\0') return {};
  return models / fs::path(path).lexically_relative(kBundledModels.folder);
}

}  // namespace

bool add_data_folder(std::string path) {
  if (path.size() > 1 && path.front() == '"' && path.back() == '"') path = path.substr(1, path.size() - 2);
  const std::scoped_lock lock(added().mutex);
  added().folders.emplace_back(std::move(path));
  return true;
}

std::optional<fs::path> bundled_file(const std::string& path) {
  if (const fs::path place = place_of_caller(path); is_present(place)) return place.lexically_normal();
  for (const fs::path& folder : data_folders()) {
    if (is_present(folder / path)) return (folder / path).lexically_normal();
  }
  return std::nullopt;
}

std::optional<fs::path> bundled_model() {
  return bundled_file("models/e2lf-n4.safetensors");
}

std::vector<std::string> bundled_names(const BundledKind& kind) {
  std::vector<std::string> names;
  for (const fs::path& path : paths_in(bundled_file(kind.folder).value_or(""))) {
    if (path.extension() == kind.extension) names.push_back(path.stem().string());
  }
  std::ranges::sort(names);
  return names;
}

std::optional<fs::path> bundled_file_named(const BundledKind& kind, const std::string& name) {
  const std::string folder = cat(kind.folder, "/");
  const std::string own = name.starts_with(folder) ? name.substr(folder.size()) : name;
  if (own.empty() || own.find('/') != std::string::npos) return std::nullopt;
  return bundled_file(cat(folder, own, own.ends_with(kind.extension) ? "" : kind.extension));
}

std::string shown_name(const BundledKind& kind, const fs::path& path) {
  return path == bundled_file_named(kind, path.stem().string()) ? path.stem().string() : path.string();
}

Result<fs::path> find_file_or_bundled(const BundledKind& kind, const std::string& name) {
  if (is_file(name)) return fs::path(name);
  if (auto bundled = bundled_file_named(kind, name)) return std::move(*bundled);
  if (is_present(name)) return fs::path(name);
  const std::vector<std::string> names = bundled_names(kind);
  const std::string remedy =
      names.empty() ? "give its path: the files of e2lf were not found, whose folder models E2LF_MODELS names"
                    : cat("give one, or a bundled ", kind.bundled, ": ", join(names),
                          "; for others, let E2LF_MODELS name the folder models of the sources of e2lf");
  return fail(ErrorCode::kNotFound, name, "there is no such ", kind.any, "; ", remedy);
}

}  // namespace e2lf
