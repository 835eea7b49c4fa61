// SPDX-License-Identifier: MIT
#include "e2lf/hdf5/checked_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <map>
#include <new>
#include <unistd.h>
#include <vector>

#include "e2lf/base/text.h"

namespace e2lf::hdf5 {
namespace {

struct WrittenFile : DriverFile {
  int descriptor = -1;
  std::shared_ptr<int> error_number;
  std::map<haddr_t, std::vector<uint8_t>> kept;  ///< the data that did not reach the disk
};

WrittenFile& of(H5FD_t* file) {
  return *static_cast<WrittenFile*>(file);
}

/// Receives the error of the H5Fcreate() in progress.
std::shared_ptr<int>& error_number_to_use() {
  static std::shared_ptr<int> error_number;
  return error_number;
}

H5FD_t* open_file(const char* path, unsigned, hid_t, haddr_t) {
  if (error_number_to_use() == nullptr) return nullptr;
  const int descriptor = ::open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    *error_number_to_use() = errno;
    return nullptr;
  }
  auto* const file = new (std::nothrow) WrittenFile();
  if (file == nullptr) {
    ::close(descriptor);
    return nullptr;
  }
  file->descriptor = descriptor;
  file->error_number = error_number_to_use();
  return file;
}

herr_t close_file(H5FD_t* file) {
  if (::close(of(file).descriptor) != 0 && *of(file).error_number == 0) *of(file).error_number = errno;
  delete static_cast<WrittenFile*>(file);
  return 0;
}

herr_t write_file(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t begin, size_t count, const void* bytes) {
  WrittenFile& own = of(file);
  own.end_of_file = std::max(own.end_of_file, begin + count);
  const auto* next = static_cast<const uint8_t*>(bytes);
  while (count > 0) {
    const ssize_t written = ::pwrite(own.descriptor, next, count, static_cast<off_t>(begin));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      if (*own.error_number == 0) *own.error_number = written < 0 ? errno : EIO;
      own.kept[begin].assign(next, next + count);
      return 0;
    }
    next += written;
    begin += static_cast<haddr_t>(written);
    count -= static_cast<size_t>(written);
  }
  return 0;
}

herr_t read_file(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t begin, size_t count, void* out) {
  const WrittenFile& own = of(file);
  auto* const bytes = static_cast<uint8_t*>(out);
  std::memset(bytes, 0, count);
  for (size_t filled = 0; filled < count;) {
    const ssize_t read = ::pread(own.descriptor, bytes + filled, count - filled, static_cast<off_t>(begin + filled));
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) break;
    filled += static_cast<size_t>(read);
  }
  for (const auto& [kept_begin, kept] : own.kept) {
    const haddr_t from = std::max(begin, kept_begin), to = std::min(begin + count, kept_begin + kept.size());
    if (from < to) std::memcpy(bytes + (from - begin), kept.data() + (from - kept_begin), to - from);
  }
  return 0;
}

/// Sets the length of the file to the end of its addresses, as the library expects.
herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  WrittenFile& own = of(file);
  if (::ftruncate(own.descriptor, static_cast<off_t>(own.end_of_addresses)) != 0 && *own.error_number == 0) {
    *own.error_number = errno;
  }
  own.end_of_file = own.end_of_addresses;
  return 0;
}

/// Reports the features of the library's own driver, because its buffers make writing fast.
herr_t query(const H5FD_t*, unsigned long* features) {  // NOLINT(google-runtime-int): the library's type
  if (features != nullptr) {
    *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
                H5FD_FEAT_AGGREGATE_SMALLDATA;
  }
  return 0;
}

hid_t register_driver() {
  constexpr H5FD_mem_t kKinds[] = H5FD_FLMAP_DICHOTOMY;
  H5FD_class_t driver = make_driver("e2lf-checked", kKinds);
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.read = read_file;
  driver.write = write_file;
  driver.truncate = truncate;
  return H5FDregister(&driver);
}

}  // namespace

Result<CheckedFile> CheckedFile::create(const std::filesystem::path& path, const std::string& name) {
  static const hid_t driver = register_driver();
  CheckedFile file;
  file.name_ = name;
  file.error_number_ = std::make_shared<int>(0);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  error_number_to_use() = file.error_number_;
  if (H5Pset_driver(access.get(), driver, nullptr) >= 0) {
    file.file_ = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  }
  error_number_to_use() = nullptr;
  E2LF_RETURN_IF_ERROR(file.check());
  if (!file.file_.valid()) return fail_to("write", name, EIO);
  return file;
}

Result<void> CheckedFile::check() const {
  if (*error_number_ != 0) return fail_to("write", name_, *error_number_);
  return {};
}

void CheckedFile::keep_up() {
  kept_up_ = std::chrono::steady_clock::now();
  H5Fflush(file_.get(), H5F_SCOPE_LOCAL);
}

bool CheckedFile::is_behind() const {
  return std::chrono::steady_clock::now() - kept_up_ >= std::chrono::seconds(1);
}

Result<void> CheckedFile::close() {
  const bool is_closed = file_.close();
  E2LF_RETURN_IF_ERROR(check());
  if (is_closed) return {};
  return fail(ErrorCode::kIo, name_, "the HDF5 library could not finish the file (", last_reason(),
              "); check the disk");
}

}  // namespace e2lf::hdf5
