// SPDX-License-Identifier: MIT
#include "e2lf/hdf5/library.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <memory>
#include <new>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace e2lf::hdf5 {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint16_t kLayoutMessage = 8;
constexpr uint8_t kChunked = 2;

size_t u16(Bytes bytes, size_t at) {
  return static_cast<size_t>(bytes[at] | (bytes[at + 1] << 8));
}

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
    const size_t type = version == 1 ? u16(messages, 0) : messages[0], size = u16(messages, version == 1 ? 2 : 1);
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

namespace {

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

struct ReadFile : DriverFile {
  std::shared_ptr<const Contents> contents;
};

/// The contents for the H5Fopen() in progress; null if the library opens a file that another one refers to.
std::shared_ptr<const Contents>& contents_to_open() {
  static std::shared_ptr<const Contents> contents;
  return contents;
}

H5FD_t* open_file(const char*, unsigned flags, hid_t, haddr_t) {
  if (contents_to_open() == nullptr || (flags & H5F_ACC_RDWR) != 0) return nullptr;
  auto* const file = new (std::nothrow) ReadFile();
  if (file == nullptr) return nullptr;
  file->contents = contents_to_open();
  file->end_of_file = file->contents->size();
  return file;
}

herr_t close_file(H5FD_t* file) {
  delete static_cast<ReadFile*>(file);
  return 0;
}

herr_t read_file(H5FD_t* file, H5FD_mem_t kind, hid_t, haddr_t begin, size_t count, void* out) {
  auto* const bytes = static_cast<uint8_t*>(out);
  if (!static_cast<ReadFile*>(file)->contents->read(begin, count, bytes)) return -1;
  return kind != H5FD_MEM_OHDR || chunks_have_dimensions({bytes, count}) ? 0 : -1;
}

herr_t refuse_to_write(H5FD_t*, H5FD_mem_t, hid_t, haddr_t, size_t, const void*) {
  return -1;
}

/// Reports no features, because each of them enables one of the library's buffers.
herr_t query(const H5FD_t*, unsigned long* features) {  // NOLINT(google-runtime-int): the library's type
  if (features != nullptr) *features = 0;
  return 0;
}

hid_t register_driver() {
  constexpr H5FD_mem_t kOneKind[] = H5FD_FLMAP_SINGLE;
  H5FD_class_t driver = make_driver("e2lf", kOneKind);
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.read = read_file;
  driver.write = refuse_to_write;
  return H5FDregister(&driver);
}

Handle open_to_read(std::shared_ptr<const Contents> contents, const char* name) {
  const LibraryLock lock;
  static const hid_t driver = register_driver();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (H5Pset_driver(access.get(), driver, nullptr) < 0) return {};
  contents_to_open() = std::move(contents);
  Handle file(H5Fopen(name, H5F_ACC_RDONLY, access.get()), H5Fclose);
  contents_to_open() = nullptr;
  return file;
}

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
  return open_to_read(std::make_shared<const Contents>(path), path.c_str());
}

Handle open_bytes(std::vector<uint8_t> bytes) {
  return open_to_read(std::make_shared<const Contents>(std::move(bytes)), "in memory");
}

H5FD_class_t make_driver(const char* name, const H5FD_mem_t (&kinds)[H5FD_MEM_NTYPES]) {
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
  std::copy(std::begin(kinds), std::end(kinds), driver.fl_map);
  return driver;
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
