// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf {

/// A locked folder beside a result, in which the result is made before it is put in place: NAME.PID.N.part. Its lock
/// ends with the process, however that ends, so a run can tell a dead one from one that is being written.
class Workspace {
 public:
  /// Gets a dead workspace of the same target before it is removed.
  using OnDead = std::function<void(const std::filesystem::path& workspace)>;

  /// Makes missing parent folders and the workspace, and removes dead workspaces of the same target with a warning.
  /// Fails with kIo, and kExists when another process is writing to this target.
  [[nodiscard]] static Result<Workspace> create(const std::filesystem::path& target, const OnDead& on_dead = {});

  Workspace(Workspace&& other) noexcept;
  Workspace& operator=(Workspace&& other) noexcept;
  /// Removes the workspace with what is in it. Links are removed, never followed.
  ~Workspace();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  Workspace(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::filesystem::path path_;
  int lock_ = -1;
};

/// A text for people with the names of results in place of those of this process's workspaces and temporary files:
/// "a/x.csv.7.1.part/x.csv" and "a/x.csv.7.1.part" are "a/x.csv".
[[nodiscard]] std::string without_workspaces(std::string text);

/// Removes the temporary files of write_file() in a folder whose writers are dead.
void remove_dead_parts(const std::filesystem::path& folder);

}  // namespace e2lf
