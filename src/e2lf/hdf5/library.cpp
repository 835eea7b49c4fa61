// SPDX-License-Identifier: MIT
#include "e2lf/hdf5/library.h"

#include "e2lf/hdf5/bytes_driver.h"

namespace e2lf::hdf5 {
namespace {

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

}  // namespace

LibraryLock::LibraryLock() : guard_(library_mutex()) {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

LibraryLock::~LibraryLock() {
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

bool Handle::close() {
  if (!valid()) return true;
  const LibraryLock lock;
  return close_(std::exchange(id_, -1)) >= 0;
}

Handle open_file(const std::filesystem::path& path) {
  const LibraryLock lock;
  return {open_path_to_read(path), H5Fclose};
}

Handle open_bytes(std::vector<uint8_t> bytes) {
  const LibraryLock lock;
  return {open_bytes_to_read(std::move(bytes)), H5Fclose};
}

std::string last_reason() {
  std::string reason = "no reason given";
  // "Upward" begins at the innermost function, so that the first entry is the root cause.
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned number, const H5E_error2_t* error, void* text) -> herr_t {
        if (number == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
        return 0;
      },
      &reason);
  return reason;
}

}  // namespace e2lf::hdf5
