// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Reads a whole file. Fails with kNotFound, or with kIo for a folder, missing permissions or an incomplete read.
[[nodiscard]] Result<std::vector<uint8_t>> read_file(const std::filesystem::path& path);

/// Reads the first `most` bytes of a file, or all of it if it is shorter. Fails as read_file does.
[[nodiscard]] Result<std::vector<uint8_t>> read_head(const std::filesystem::path& path, size_t most);

/// Writes a file atomically: the bytes go to a sibling of `path`, which is then renamed, so that readers see either the
/// old file or the whole new one. Missing parent folders are created, and an existing file is replaced (check_output()
/// guards against that). To a device, pipe or socket the bytes are written directly. Fails with kIo.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const uint8_t> bytes);
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, const std::string& text);

/// Writes all bytes to an open descriptor; `path` is its name in errors. Fails with kIo.
[[nodiscard]] Result<void> write_all(int descriptor, const std::filesystem::path& path, std::span<const uint8_t> bytes);

/// Fails with kExists if `path` exists and `overwrite` is false, or if it is a folder. It is called before the work
/// starts.
[[nodiscard]] Result<void> check_output(const std::filesystem::path& path, bool overwrite);

/// Returns true if `path` is a device, a named pipe or a socket: bytes written there leave in order and cannot be taken
/// back.
[[nodiscard]] bool is_stream(const std::filesystem::path& path);

/// Opens a stream for writing and returns its descriptor. For a named pipe, this waits for a reader. Fails with kIo,
/// and with kCancelled if a stop is requested meanwhile.
[[nodiscard]] Result<int> open_stream(const std::filesystem::path& path);

/// A file that appears either whole or not at all, for writers that write piece by piece. They write to path(), a
/// sibling of `target` with a temporary name, and commit() renames it. Without commit(), the destructor removes what
/// was written.
class AtomicFile {
 public:
  /// Chooses the name of the sibling and creates missing parent folders. Fails with kIo, and with kUnsupported if
  /// `target` is a device, pipe or socket.
  [[nodiscard]] static Result<AtomicFile> create(const std::filesystem::path& target);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  [[nodiscard]] const std::filesystem::path& path() const { return staging_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Renames the file to its target, replacing an existing one. Fails with kIo.
  [[nodiscard]] Result<void> commit();

 private:
  AtomicFile(std::filesystem::path target, std::filesystem::path staging)
      : target_(std::move(target)), staging_(std::move(staging)) {}
  std::filesystem::path target_;
  std::filesystem::path staging_;
};

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

/// Return whether a path leads to anything, to a regular file, and to a folder. What cannot be looked at is not there.
[[nodiscard]] bool is_present(const std::filesystem::path& path);
[[nodiscard]] bool is_file(const std::filesystem::path& path);
[[nodiscard]] bool is_folder(const std::filesystem::path& path);

/// Returns the paths of what a folder contains, sorted; fewer or none if it cannot be listed.
[[nodiscard]] std::vector<std::filesystem::path> paths_in(const std::filesystem::path& folder);

/// Returns the folder in which a path lies, "." for a plain name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& path);

/// Removes the temporary files in a folder that were left by calls of write_file() in processes that have ended.
void remove_dead_parts(const std::filesystem::path& folder);

/// Returns true if the name of a file comes before another one where numbers in names count as numbers: bag_2 before
/// bag_10, and -2 before -1 before 0. A minus that follows a letter or a digit separates two parts of a name.
[[nodiscard]] bool is_before_in_number_order(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace e2lf
