// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf {

/// A locked folder beside a result, NAME.PID.N.part, in which the result is made before it is moved to its place. The
/// lock ends with the process, however that ends, so that a run can distinguish an abandoned workspace from one in use.
class Workspace {
 public:
  /// Creates missing parent folders and the workspace, and removes abandoned workspaces of the same target with a
  /// warning. Those of live input (`is_live`), which cannot be recorded again, are named and left to the user. Fails
  /// with kIo, and with kExists if another process is writing to this target.
  [[nodiscard]] static Result<Workspace> create(const std::filesystem::path& target, bool is_live = false);

  Workspace(Workspace&& other) noexcept;
  Workspace& operator=(Workspace&& other) noexcept;
  /// Removes the workspace and its content. Links are removed but never followed.
  ~Workspace();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  Workspace(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::filesystem::path path_;
  int lock_ = -1;
};

/// Replaces the names of this process's workspaces and temporary files in a message by those of the results:
/// "a/x.csv.7.1.part/x.csv" and "a/x.csv.7.1.part" become "a/x.csv".
[[nodiscard]] std::string without_workspaces(std::string text);

/// Returns true if something has this name, be it a link to nothing.
[[nodiscard]] bool is_there(const std::filesystem::path& path);

/// Removes the temporary files in a folder that were left by calls of write_file() in processes that have ended.
void remove_dead_parts(const std::filesystem::path& folder);

}  // namespace e2lf
