// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>

#include "e2lf/base/result.h"
#include "e2lf/hdf5/library.h"

namespace e2lf::hdf5 {

/// A new HDF5 file whose writing may fail, on a full disk above all. The library cannot take that: it keeps what it
/// could not write and crashes when the process ends. So a driver of our own tells it that all is well, keeps the bytes
/// that did not get to the disk, and has the error for those who ask. The caller holds the library's lock.
class CheckedFile {
 public:
  CheckedFile() = default;

  /// Makes or empties the file. `name` goes into errors. Fails with kIo.
  [[nodiscard]] static Result<CheckedFile> create(const std::filesystem::path& path, const std::string& name);

  [[nodiscard]] hid_t get() const { return file_.get(); }

  /// The first write that failed. To be asked after every stretch of data, before more is written.
  [[nodiscard]] Result<void> check() const;

  /// Brings the file up to date on the disk, so that a run that is killed leaves one that can be opened. What could not
  /// be written is in check().
  void keep_up();
  /// Whether that was never done, or not for a second.
  [[nodiscard]] bool is_behind() const;

  /// Closes the file, after all of its objects. Fails with kIo when anything did not get to the disk.
  [[nodiscard]] Result<void> close();

 private:
  std::string name_;
  std::shared_ptr<int> error_number_;
  Handle file_;
  std::chrono::steady_clock::time_point kept_up_{};
};

}  // namespace e2lf::hdf5
