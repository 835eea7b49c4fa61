// SPDX-License-Identifier: MIT
#include "e2lf/hdf5/library.h"

namespace e2lf::hdf5 {
namespace {

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// HDF5 1.10 reads beyond its sieve buffer where a damaged file puts elements past its end.
Handle safe_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_sieve_buf_size(access.get(), 0);
  return access;
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
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, safe_access().get()), H5Fclose};
}

Handle open_bytes(std::span<uint8_t> bytes, const std::string& name) {
  constexpr size_t kGrowBytes = size_t{1} << 20;
  const LibraryLock lock;
  const Handle access = safe_access();
  H5Pset_fapl_core(access.get(), kGrowBytes, false);
  H5Pset_file_image(access.get(), bytes.data(), bytes.size());
  return {H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose};
}

std::string last_reason() {
  std::string reason = "no reason given";
  // Upward = from the innermost function out, so the first entry is the root.
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
