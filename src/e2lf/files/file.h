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

}  // namespace e2lf
