// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/formats/hdf5_write.h"

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/hdf5/library.h"

namespace e2lf::lightfield {
namespace {

/// Returns the bytes of an HDF5 file that is made in memory, or none if HDF5 fails.
std::vector<uint8_t> encode_hdf5(const std::string& name, const std::vector<size_t>& extents,
                                 std::span<const float> values) {
  constexpr size_t kGrowBytes = size_t{1} << 24;
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!access.valid() || H5Pset_fapl_core(access.get(), kGrowBytes, 0) < 0) return {};
  const hdf5::Handle file(H5Fcreate("memory.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  const std::vector<hsize_t> sizes(extents.begin(), extents.end());
  const hdf5::Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  if (!file.valid() || !space.valid()) return {};
  const hdf5::Handle set(
      H5Dcreate2(file.get(), name.c_str(), H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  if (!set.valid() || H5Dwrite(set.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0 ||
      H5Fflush(file.get(), H5F_SCOPE_GLOBAL) < 0) {
    return {};
  }
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  std::vector<uint8_t> bytes(size > 0 ? static_cast<size_t>(size) : 0);
  if (bytes.empty() || H5Fget_file_image(file.get(), bytes.data(), bytes.size()) != size) return {};
  return bytes;
}

}  // namespace

Result<void> write_hdf5(const std::filesystem::path& path, const std::string& name, const std::vector<size_t>& extents,
                        std::span<const float> values) {
  const hdf5::LibraryLock lock;
  const std::vector<uint8_t> bytes = encode_hdf5(name, extents, values);
  if (bytes.empty()) {
    return Error{ErrorCode::kInternal,
                 cat("HDF5 could not encode ", name, " (", hdf5::last_reason(), "); write npy instead"), path.string()};
  }
  return write_file(path, bytes);
}

}  // namespace e2lf::lightfield
