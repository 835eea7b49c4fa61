// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>

#include "e2lf/base/result.h"
#include "e2lf/hdf5/library.h"

namespace e2lf::hdf5 {

/// A new HDF5 file whose writes may fail, above all on a full disk. The library cannot handle that: it keeps the data
/// that it could not write and crashes when the process ends. Our driver therefore reports success to the library,
/// keeps the bytes that did not reach the disk, and stores the error for check(). The caller must hold the library's
/// lock.
class CheckedFile {
 public:
  CheckedFile() = default;

  /// Creates the file, or empties an existing one. `name` is the location in errors. Fails with kIo.
  [[nodiscard]] static Result<CheckedFile> create(const std::filesystem::path& path, const std::string& name);

  [[nodiscard]] hid_t get() const { return file_.get(); }

  /// Returns the first write that failed. It must be called after every batch of data, before more are written.
  [[nodiscard]] Result<void> check() const;

  /// Flushes the file to the disk, so that it can be opened even if the run is killed later. Errors are reported by
  /// check().
  void keep_up();
  /// Returns true if keep_up() was never called, or not within the last second.
  [[nodiscard]] bool is_behind() const;

  /// Closes the file, after all of its objects. Fails with kIo if any data did not reach the disk.
  [[nodiscard]] Result<void> close();

 private:
  std::string name_;
  std::shared_ptr<int> error_number_;
  Handle file_;
  std::chrono::steady_clock::time_point kept_up_{};
};

}  // namespace e2lf::hdf5
