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

/// The whole file as bytes. Fails with kNotFound, kIo (a folder, no permission, a read that stops early).
[[nodiscard]] Result<std::vector<uint8_t>> read_file(const std::filesystem::path& path);

/// Its first bytes: `most` of them, or all there are. Fails as read_file does.
[[nodiscard]] Result<std::vector<uint8_t>> read_head(const std::filesystem::path& path, size_t most);

/// Writes beside `path` and renames: readers see the old file or the whole new one, never a part. Missing parent
/// folders are made. Fails with kIo; an existing file is replaced (see check_output for asking first).
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const uint8_t> bytes);
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, const std::string& text);

/// Fails with kExists when `path` is there already and `overwrite` is false. Called before work starts.
[[nodiscard]] Result<void> check_output(const std::filesystem::path& path, bool overwrite);

/// A file that appears whole or not at all, for writers that write bit by bit: they write to path(), a sibling of
/// `target` with a temporary name, and commit() renames it. Without commit() the destructor removes what was written.
class AtomicFile {
 public:
  /// Names the sibling and makes missing parent folders. Fails with kIo.
  [[nodiscard]] static Result<AtomicFile> create(const std::filesystem::path& target);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  [[nodiscard]] const std::filesystem::path& path() const { return staging_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Puts the file in place of an existing one. Fails with kIo.
  [[nodiscard]] Result<void> commit();

 private:
  AtomicFile(std::filesystem::path target, std::filesystem::path staging)
      : target_(std::move(target)), staging_(std::move(staging)) {}
  std::filesystem::path target_;
  std::filesystem::path staging_;
};

}  // namespace e2lf
