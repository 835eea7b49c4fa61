// SPDX-License-Identifier: MIT
#include "e2lf/hdf5/library.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <map>
#include <new>
#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"

namespace e2lf::hdf5 {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint16_t kLayoutMessage = 8;
constexpr uint8_t kChunked = 2;

bool layout_is_usable(Bytes layout) {
  // Where the versions from 1 on state the class of a layout, and the number of dimensions of its chunks.
  constexpr size_t kClassAt[] = {2, 2, 1, 1}, kDimensionsAt[] = {1, 1, 2, 3};
  if (layout.size() < 4 || layout[0] < 1 || layout[0] > std::size(kClassAt)) return true;
  const size_t version = layout[0] - size_t{1};
  return layout[kClassAt[version]] != kChunked || layout[kDimensionsAt[version]] > 0;
}

/// Checks messages of version 1 (type and size of 2 bytes each, flags, three reserved bytes, then the data, in
/// multiples of eight bytes) or of version 2 (type, size of 2 bytes, flags and, in some headers, 2 more bytes). `head`
/// is the number of bytes before the data.
bool layouts_are_usable(Bytes messages, int version, size_t head) {
  while (messages.size() >= head) {
    const size_t type = version == 1 ? load_le<uint16_t>(messages.data()) : messages[0];
    const size_t size = load_le<uint16_t>(messages.data() + (version == 1 ? 2 : 1));
    if ((version == 1 && size % 8 != 0) || size > messages.size() - head) break;
    if (type == kLayoutMessage && !layout_is_usable(messages.subspan(head, size))) return false;
    messages = messages.subspan(head + size);
  }
  return true;
}

bool begins_with(Bytes piece, const char (&signature)[5]) {
  return piece.size() >= 4 && std::memcmp(piece.data(), signature, 4) == 0;
}

/// Returns the offset of the messages in a version 2 header, after signature, version, flags, times, limits and size.
size_t v2_prefix(Bytes piece) {
  if (piece.size() < 6) return piece.size();
  const unsigned flags = piece[5];
  return 6 + ((flags & 0x20) != 0 ? 16 : 0) + ((flags & 0x10) != 0 ? 4 : 0) + (size_t{1} << (flags & 3));
}

Bytes after(Bytes piece, size_t count) {
  return count < piece.size() ? piece.subspan(count) : Bytes{};
}

/// The source of a file's data: bytes in memory or a descriptor.
class Contents {
 public:
  explicit Contents(std::vector<uint8_t> bytes) : bytes_(std::move(bytes)), size_(bytes_.size()) {}
  explicit Contents(const std::filesystem::path& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat info {};
    if (descriptor_ >= 0 && ::fstat(descriptor_, &info) == 0 && S_ISREG(info.st_mode)) {
      size_ = static_cast<uint64_t>(info.st_size);
    }
  }
  Contents(const Contents&) = delete;
  Contents& operator=(const Contents&) = delete;
  ~Contents() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  [[nodiscard]] uint64_t size() const { return size_; }

  /// Returns false if the range does not lie entirely within the file or cannot be read; `out` is then unspecified.
  [[nodiscard]] bool read(uint64_t begin, size_t count, uint8_t* out) const {
    if (begin > size_ || count > size_ - begin) return false;
    if (descriptor_ < 0) {
      if (count > 0) std::memcpy(out, bytes_.data() + begin, count);
      return true;
    }
    while (count > 0) {
      const ssize_t read = ::pread(descriptor_, out, count, static_cast<off_t>(begin));
      if (read < 0 && errno == EINTR) continue;
      if (read <= 0) return false;
      out += read;
      begin += static_cast<uint64_t>(read);
      count -= static_cast<size_t>(read);
    }
    return true;
  }

 private:
  std::vector<uint8_t> bytes_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

/// An open file of one of our drivers, as the library sees it.
struct DriverFile : H5FD_t {
  haddr_t end_of_addresses = 0, end_of_file = 0;
};

/// Registers the driver whose files are of type File, with one kind of memory for each of `kinds`.
template <typename File>
hid_t register_driver(const char* name, const H5FD_mem_t (&kinds)[H5FD_MEM_NTYPES]) {
  H5FD_class_t driver{};
  driver.name = name;
  driver.maxaddr = INT64_MAX;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.get_eoa = [](const H5FD_t* file, H5FD_mem_t) {
    return static_cast<const DriverFile*>(file)->end_of_addresses;
  };
  driver.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t end) -> herr_t {
    static_cast<DriverFile*>(file)->end_of_addresses = end;
    return 0;
  };
  driver.get_eof = [](const H5FD_t* file, H5FD_mem_t) { return static_cast<const DriverFile*>(file)->end_of_file; };
  driver.query = [](const H5FD_t*, unsigned long* features) -> herr_t {  // NOLINT(google-runtime-int): its type
    if (features != nullptr) *features = File::kFeatures;
    return 0;
  };
  driver.open = File::open;
  driver.close = [](H5FD_t* file) -> herr_t {
    delete static_cast<File*>(file);
    return 0;
  };
  driver.read = File::read;
  driver.write = File::write;
  if constexpr (requires { File::truncate; }) driver.truncate = File::truncate;
  std::copy(std::begin(kinds), std::end(kinds), driver.fl_map);
  return H5FDregister(&driver);
}

/// A file, or the bytes of one, that is read.
struct ReadFile : DriverFile {
  /// None, because each of them enables one of the library's buffers.
  static constexpr unsigned long kFeatures = 0;  // NOLINT(google-runtime-int): the library's type

  explicit ReadFile(std::shared_ptr<const Contents> opened) : DriverFile{}, contents(std::move(opened)) {
    end_of_file = contents->size();
  }

  /// The contents for the H5Fopen() in progress; null if the library opens a file that another one refers to.
  static std::shared_ptr<const Contents>& contents_to_open() {
    static std::shared_ptr<const Contents> opened;
    return opened;
  }

  static H5FD_t* open(const char*, unsigned flags, hid_t, haddr_t) {
    if (contents_to_open() == nullptr || (flags & H5F_ACC_RDWR) != 0) return nullptr;
    return new (std::nothrow) ReadFile(contents_to_open());
  }

  static herr_t read(H5FD_t* file, H5FD_mem_t kind, hid_t, haddr_t begin, size_t count, void* out) {
    auto* const bytes = static_cast<uint8_t*>(out);
    if (!static_cast<ReadFile*>(file)->contents->read(begin, count, bytes)) return -1;
    return kind != H5FD_MEM_OHDR || chunks_have_dimensions({bytes, count}) ? 0 : -1;
  }

  static herr_t write(H5FD_t*, H5FD_mem_t, hid_t, haddr_t, size_t, const void*) { return -1; }

  std::shared_ptr<const Contents> contents;
};

/// The file of a CheckedFile.
struct WrittenFile : DriverFile {
  /// Those of the library's own driver, because its buffers make writing fast.
  static constexpr unsigned long kFeatures =  // NOLINT(google-runtime-int): the library's type
      H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
      H5FD_FEAT_AGGREGATE_SMALLDATA;

  WrittenFile(int opened, std::shared_ptr<int> error)
      : DriverFile{}, descriptor(opened), error_number(std::move(error)) {}
  WrittenFile(const WrittenFile&) = delete;
  WrittenFile& operator=(const WrittenFile&) = delete;
  ~WrittenFile() {
    if (::close(descriptor) != 0) keep_error(errno);
  }

  void keep_error(int number) const {
    if (*error_number == 0) *error_number = number;
  }

  /// Receives the error of the H5Fcreate() in progress.
  static std::shared_ptr<int>& error_number_to_use() {
    static std::shared_ptr<int> number;
    return number;
  }

  static H5FD_t* open(const char* path, unsigned, hid_t, haddr_t) {
    if (error_number_to_use() == nullptr) return nullptr;
    const int opened = ::open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (opened < 0) {
      *error_number_to_use() = errno;
      return nullptr;
    }
    auto* const file = new (std::nothrow) WrittenFile(opened, error_number_to_use());
    if (file == nullptr) ::close(opened);
    return file;
  }

  static herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t begin, size_t count, const void* bytes) {
    WrittenFile& own = *static_cast<WrittenFile*>(file);
    own.end_of_file = std::max(own.end_of_file, begin + count);
    const auto* next = static_cast<const uint8_t*>(bytes);
    while (count > 0) {
      const ssize_t written = ::pwrite(own.descriptor, next, count, static_cast<off_t>(begin));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) {
        own.keep_error(written < 0 ? errno : EIO);
        own.kept[begin].assign(next, next + count);
        return 0;
      }
      next += written;
      begin += static_cast<haddr_t>(written);
      count -= static_cast<size_t>(written);
    }
    return 0;
  }

  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t begin, size_t count, void* out) {
    const WrittenFile& own = *static_cast<const WrittenFile*>(file);
    auto* const bytes = static_cast<uint8_t*>(out);
    std::memset(bytes, 0, count);
    for (size_t filled = 0; filled < count;) {
      const ssize_t got = ::pread(own.descriptor, bytes + filled, count - filled, static_cast<off_t>(begin + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      filled += static_cast<size_t>(got);
    }
    for (const auto& [kept_begin, kept] : own.kept) {
      const haddr_t from = std::max(begin, kept_begin), to = std::min(begin + count, kept_begin + kept.size());
      if (from < to) std::memcpy(bytes + (from - begin), kept.data() + (from - kept_begin), to - from);
    }
    return 0;
  }

  /// Sets the length of the file to the end of its addresses, as the library expects.
  static herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
    WrittenFile& own = *static_cast<WrittenFile*>(file);
    if (::ftruncate(own.descriptor, static_cast<off_t>(own.end_of_addresses)) != 0) own.keep_error(errno);
    own.end_of_file = own.end_of_addresses;
    return 0;
  }

  int descriptor;
  std::shared_ptr<int> error_number;
  std::map<haddr_t, std::vector<uint8_t>> kept;  ///< the data that did not reach the disk
};

Handle open_to_read(std::shared_ptr<const Contents> contents, const char* name) {
  const LibraryLock lock;
  constexpr H5FD_mem_t kOneKind[] = H5FD_FLMAP_SINGLE;
  static const hid_t driver = register_driver<ReadFile>("e2lf", kOneKind);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (H5Pset_driver(access.get(), driver, nullptr) < 0) return {};
  ReadFile::contents_to_open() = std::move(contents);
  Handle file(H5Fopen(name, H5F_ACC_RDONLY, access.get()), H5Fclose);
  ReadFile::contents_to_open() = nullptr;
  return file;
}

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

}  // namespace

bool chunks_have_dimensions(Bytes piece) {
  if (begins_with(piece, "OHDR") || begins_with(piece, "OCHK")) {
    const auto messages = after(piece, piece[1] == 'H' ? v2_prefix(piece) : 4);
    // A continuation does not state how long the heads of its messages are, so both lengths are tried.
    return layouts_are_usable(messages, 2, 4) && layouts_are_usable(messages, 2, 6);
  }
  // A piece of version 1 does not state whether it begins with the prefix of 16 bytes, so both cases are tried.
  return layouts_are_usable(piece, 1, 8) && layouts_are_usable(after(piece, 16), 1, 8);
}

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
  return open_to_read(std::make_shared<const Contents>(path), path.c_str());
}

Handle open_bytes(std::vector<uint8_t> bytes) {
  return open_to_read(std::make_shared<const Contents>(std::move(bytes)), "in memory");
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

Result<CheckedFile> CheckedFile::create(const std::filesystem::path& path, const std::string& name) {
  constexpr H5FD_mem_t kKinds[] = H5FD_FLMAP_DICHOTOMY;
  static const hid_t driver = register_driver<WrittenFile>("e2lf-checked", kKinds);
  CheckedFile file;
  file.name_ = name;
  file.error_number_ = std::make_shared<int>(0);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  WrittenFile::error_number_to_use() = file.error_number_;
  if (H5Pset_driver(access.get(), driver, nullptr) >= 0) {
    file.file_ = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  }
  WrittenFile::error_number_to_use() = nullptr;
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
