// SPDX-License-Identifier: MIT
#include "e2lf/files/zip.h"

#include <algorithm>
#include <set>
#include <utility>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"

namespace e2lf::zip {
namespace {

constexpr uint32_t kLocalHeader = 0x04034b50;
constexpr uint32_t kDirectoryEntry = 0x02014b50;
constexpr uint32_t kDirectoryEnd = 0x06054b50;
constexpr uint32_t kDirectoryEnd64 = 0x06064b50;
constexpr uint32_t kLocator64 = 0x07064b50;

constexpr uint64_t kLocalHeaderSize = 30;
constexpr uint64_t kDirectoryEntrySize = 46;
constexpr uint64_t kDirectoryEndSize = 22;
constexpr uint64_t kDirectoryEnd64Size = 56;
constexpr uint64_t kLocator64Size = 20;

constexpr uint16_t kExtra64 = 1;                 ///< id of the extra field with 64-bit sizes
constexpr uint16_t kLocalExtraSize = 20;         ///< size of this field in our local headers
constexpr uint32_t kIn64 = 0xFFFFFFFF;           ///< means "the value is in the zip64 record"
constexpr uint16_t kCountIn64 = 0xFFFF;          ///< the same for counts
constexpr uint16_t kVersion64 = 45;              ///< the version needed to extract
constexpr size_t kMostAtOnce = size_t{1} << 30;  ///< zlib counts in 32 bits

template <typename T>
void put(std::vector<uint8_t>& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  store_le(bytes.data() + bytes.size() - sizeof(T), value);
}

/// Appends the fields that the local header and the directory share, from the version needed to the length of the extra
/// field.
void put_common(std::vector<uint8_t>& bytes, const Member& member, uint16_t extra_size) {
  put<uint16_t>(bytes, kVersion64);
  put<uint16_t>(bytes, 1U << 11);  // UTF-8 names
  put<uint16_t>(bytes, member.method);
  put<uint32_t>(bytes, 0x00210000);  // 1980-01-01 00:00, so that equal members give equal files
  put<uint32_t>(bytes, member.crc);
  put<uint32_t>(bytes, kIn64);
  put<uint32_t>(bytes, kIn64);
  put<uint16_t>(bytes, static_cast<uint16_t>(member.name.size()));
  put<uint16_t>(bytes, extra_size);
}

/// Appends the name and the beginning of the extra field, up to the sizes.
void put_name_and_sizes(std::vector<uint8_t>& bytes, const Member& member, uint16_t extra_size) {
  bytes.insert(bytes.end(), member.name.begin(), member.name.end());
  put<uint16_t>(bytes, kExtra64);
  put<uint16_t>(bytes, extra_size - 4);
  put<uint64_t>(bytes, member.size);
  put<uint64_t>(bytes, member.packed);
}

}  // namespace

std::vector<uint8_t> local_header(const Member& member) {
  std::vector<uint8_t> bytes;
  put<uint32_t>(bytes, kLocalHeader);
  put_common(bytes, member, kLocalExtraSize);
  put_name_and_sizes(bytes, member, kLocalExtraSize);
  return bytes;
}

std::vector<uint8_t> directory(std::span<const Member> members, uint64_t offset) {
  constexpr uint16_t kExtraSize = kLocalExtraSize + 8;  // with the offset
  std::vector<uint8_t> bytes;
  for (const Member& member : members) {
    put<uint32_t>(bytes, kDirectoryEntry);
    put<uint16_t>(bytes, kVersion64);  // made by
    put_common(bytes, member, kExtraSize);
    put<uint64_t>(bytes, 0);  // comment length, disk and attributes
    put<uint16_t>(bytes, 0);
    put<uint32_t>(bytes, kIn64);
    put_name_and_sizes(bytes, member, kExtraSize);
    put<uint64_t>(bytes, member.offset);
  }
  const uint64_t size = bytes.size();
  put<uint32_t>(bytes, kDirectoryEnd64);
  put<uint64_t>(bytes, kDirectoryEnd64Size - 12);
  put<uint16_t>(bytes, kVersion64);
  put<uint16_t>(bytes, kVersion64);
  put<uint64_t>(bytes, 0);  // this disk, the directory's disk
  put<uint64_t>(bytes, members.size());
  put<uint64_t>(bytes, members.size());
  put<uint64_t>(bytes, size);
  put<uint64_t>(bytes, offset);
  put<uint32_t>(bytes, kLocator64);
  put<uint32_t>(bytes, 0);
  put<uint64_t>(bytes, offset + size);
  put<uint32_t>(bytes, 1);  // disks
  put<uint32_t>(bytes, kDirectoryEnd);
  put<uint32_t>(bytes, 0);  // this disk, the directory's disk
  put<uint16_t>(bytes, kCountIn64);
  put<uint16_t>(bytes, kCountIn64);
  put<uint32_t>(bytes, kIn64);
  put<uint32_t>(bytes, kIn64);
  put<uint16_t>(bytes, 0);  // comment length
  return bytes;
}

namespace {

/// Gives zlib the next part of `input` when it has used the last one.
void refill(z_stream& stream, std::span<const uint8_t>& input) {
  if (stream.avail_in != 0 || input.empty()) return;
  const size_t taken = std::min(input.size(), kMostAtOnce);
  stream.next_in = const_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(taken);
  input = input.subspan(taken);
}

}  // namespace

Deflater::Deflater(int level) {
  // Negative bits: no zlib header, as in zip archives.
  const int started = deflateInit2(&stream_, level, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  E2LF_REQUIRE(started == Z_OK, "zlib did not start");
}

Result<void> Deflater::add(std::span<const uint8_t> bytes, int flush, const Sink& sink) {
  std::vector<uint8_t> packed(size_t{1} << 18);
  do {
    refill(stream_, bytes);
    stream_.next_out = packed.data();
    stream_.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream_, bytes.empty() ? flush : Z_NO_FLUSH);
    E2LF_RETURN_IF_ERROR(sink(std::span<const uint8_t>(packed).first(packed.size() - stream_.avail_out)));
  } while (stream_.avail_out == 0 || stream_.avail_in > 0 || !bytes.empty());
  return {};
}

}  // namespace e2lf::zip

namespace e2lf {

void ZipWriter::add(const std::string& name, std::span<const uint8_t> bytes, bool compress) {
  E2LF_REQUIRE(name.size() <= 0xFFFF, "the name is too long for a zip archive");
  std::vector<uint8_t> packed;
  const auto keep = [&](std::span<const uint8_t> more) {
    packed.insert(packed.end(), more.begin(), more.end());
    return Result<void>();
  };
  if (compress) static_cast<void>(zip::Deflater(Z_DEFAULT_COMPRESSION).add(bytes, Z_FINISH, keep));
  const std::span<const uint8_t> data = compress ? std::span<const uint8_t>(packed) : bytes;
  members_.push_back({.name = name,
                      .method = compress ? zip::kDeflated : zip::kStored,
                      .crc = static_cast<uint32_t>(crc32_z(0, bytes.data(), bytes.size())),
                      .packed = data.size(),
                      .size = bytes.size(),
                      .offset = taken_ + archive_.size()});
  const std::vector<uint8_t> header = zip::local_header(members_.back());
  archive_.insert(archive_.end(), header.begin(), header.end());
  archive_.insert(archive_.end(), data.begin(), data.end());
}

uint64_t ZipWriter::add_written(zip::Member member) {
  E2LF_REQUIRE(archive_.empty(), "what precedes the member is taken first");
  member.offset = taken_;
  taken_ += zip::local_header(member).size() + member.packed;
  members_.push_back(std::move(member));
  return members_.back().offset;
}

std::vector<uint8_t> ZipWriter::take() {
  taken_ += archive_.size();
  return std::exchange(archive_, {});
}

std::vector<uint8_t> ZipWriter::finish() {
  const std::vector<uint8_t> directory = zip::directory(members_, taken_ + archive_.size());
  archive_.insert(archive_.end(), directory.begin(), directory.end());
  return take();
}

namespace {

/// An archive with its name. Positions must be checked with has() before get() reads them.
struct Archive {
  std::span<const uint8_t> bytes;
  const std::string& name;

  [[nodiscard]] bool has(uint64_t position, uint64_t size) const {
    return position <= bytes.size() && size <= bytes.size() - position;
  }
  template <typename T>
  [[nodiscard]] T get(uint64_t position) const {
    return load_le<T>(bytes.data() + position);
  }
  [[nodiscard]] bool is(uint64_t position, uint64_t size, uint32_t signature) const {
    return has(position, size) && get<uint32_t>(position) == signature;
  }
  [[nodiscard]] Error damaged(uint64_t position, const char* what) const {
    return fail(ErrorCode::kFormat, cat(name, ": byte ", position), "not a readable zip archive (", what,
                "); write it again");
  }
  [[nodiscard]] Error truncated(uint64_t position, const std::string& what) const {
    return fail(ErrorCode::kTruncated, cat(name, ": byte ", position), what,
                " lies beyond the end of the archive; copy it again");
  }
};

struct Directory {
  uint64_t offset = 0, size = 0, count = 0;
};

/// Finds the end record. The search runs backwards because a comment of up to 65535 bytes may follow the record.
Result<uint64_t> find_directory_end(const Archive& archive) {
  const uint64_t size = archive.bytes.size();
  const uint64_t searched = std::min<uint64_t>(size, zip::kDirectoryEndSize + 0xFFFF);
  for (uint64_t back = zip::kDirectoryEndSize; back <= searched; ++back) {
    const uint64_t position = size - back;
    if (archive.is(position, zip::kDirectoryEndSize, zip::kDirectoryEnd) &&
        archive.get<uint16_t>(position + 20) == back - zip::kDirectoryEndSize) {
      return position;
    }
  }
  const bool is_zip = archive.is(0, zip::kLocalHeaderSize, zip::kLocalHeader);
  if (is_zip) return archive.truncated(size, "the directory");
  return archive.damaged(0, "it has no directory");
}

Result<Directory> find_directory(const Archive& archive) {
  E2LF_ASSIGN_OR_RETURN(const uint64_t end, find_directory_end(archive));
  Directory directory{archive.get<uint32_t>(end + 16), archive.get<uint32_t>(end + 12),
                      archive.get<uint16_t>(end + 10)};
  bool one_disk = archive.get<uint16_t>(end + 4) == 0 && archive.get<uint16_t>(end + 6) == 0;
  if (end >= zip::kLocator64Size && archive.is(end - zip::kLocator64Size, zip::kLocator64Size, zip::kLocator64)) {
    const auto end64 = archive.get<uint64_t>(end - zip::kLocator64Size + 8);
    if (!archive.is(end64, zip::kDirectoryEnd64Size, zip::kDirectoryEnd64)) {
      return archive.damaged(end - zip::kLocator64Size, "its zip64 record is missing");
    }
    directory = {archive.get<uint64_t>(end64 + 48), archive.get<uint64_t>(end64 + 40),
                 archive.get<uint64_t>(end64 + 32)};
    one_disk = archive.get<uint32_t>(end64 + 16) == 0 && archive.get<uint32_t>(end64 + 20) == 0;
  }
  if (!one_disk) {
    return fail(ErrorCode::kUnsupported, archive.name, "the zip archive spans several disks; write it as one file");
  }
  if (!archive.has(directory.offset, directory.size)) return archive.truncated(directory.offset, "the directory");
  return directory;
}

/// Replaces the numbers of an entry that are marked as 64-bit by the values of its zip64 extra field.
Result<void> read_extra64(const Archive& archive, uint64_t begin, uint64_t end, ZipEntry& entry) {
  uint64_t* const wanted[] = {&entry.size, &entry.packed, &entry.offset};
  if (std::none_of(std::begin(wanted), std::end(wanted), [](uint64_t* value) { return *value == zip::kIn64; })) {
    return {};
  }
  for (uint64_t position = begin; position + 4 <= end;) {
    const auto id = archive.get<uint16_t>(position);
    const uint64_t field_end = position + 4 + archive.get<uint16_t>(position + 2);
    if (field_end > end) break;
    if (id == zip::kExtra64) {
      uint64_t value = position + 4;
      for (uint64_t* field : wanted) {
        if (*field != zip::kIn64) continue;
        if (value + 8 > field_end) return archive.damaged(position, "a zip64 field is too short");
        *field = archive.get<uint64_t>(value);
        value += 8;
      }
      return {};
    }
    position = field_end;
  }
  return archive.damaged(begin, "a zip64 field is missing");
}

/// Reads the fields at `position` that the local header and the directory share (put_common()), and then the name and
/// the sizes, which begin at `name_begin`. Returns their end, which is at most `limit`.
Result<uint64_t> read_common(const Archive& archive, uint64_t position, uint64_t name_begin, uint64_t limit,
                             ZipEntry& entry) {
  const uint64_t name_end = name_begin + archive.get<uint16_t>(position + 22);
  const uint64_t extra_end = name_end + archive.get<uint16_t>(position + 24);
  if (extra_end > limit) return archive.damaged(position, "the header of an entry is too long");
  const auto name = archive.bytes.subspan(name_begin, name_end - name_begin);
  entry.name.assign(name.begin(), name.end());
  entry.method = archive.get<uint16_t>(position + 4);
  entry.crc = archive.get<uint32_t>(position + 10);
  entry.packed = archive.get<uint32_t>(position + 14);
  entry.size = archive.get<uint32_t>(position + 18);
  E2LF_RETURN_IF_ERROR(read_extra64(archive, name_end, extra_end, entry));
  return extra_end;
}

/// Reads the directory entry at `position` and advances past it.
Result<ZipEntry> read_entry(const Archive& archive, uint64_t& position, uint64_t directory_end) {
  const uint64_t begin = position, name_begin = begin + zip::kDirectoryEntrySize;
  if (name_begin > directory_end || archive.get<uint32_t>(begin) != zip::kDirectoryEntry) {
    return archive.damaged(begin, "a directory entry is damaged");
  }
  ZipEntry entry;
  entry.offset = archive.get<uint32_t>(begin + 42);
  E2LF_ASSIGN_OR_RETURN(position, read_common(archive, begin + 6, name_begin, directory_end, entry));
  position += archive.get<uint16_t>(begin + 32);
  if (position > directory_end) return archive.damaged(begin, "a directory entry is too long");
  if ((archive.get<uint16_t>(begin + 8) & 1U) != 0) {
    return fail(ErrorCode::kUnsupported, archive.name, "\"", entry.name,
                "\" is encrypted; store it without a password");
  }
  if (!archive.is(entry.offset, zip::kLocalHeaderSize, zip::kLocalHeader)) {
    return archive.damaged(entry.offset, "an entry has no header");
  }
  const uint64_t data = entry.offset + zip::kLocalHeaderSize + archive.get<uint16_t>(entry.offset + 26) +
                        archive.get<uint16_t>(entry.offset + 28);
  if (!archive.has(data, entry.packed)) return archive.truncated(data, cat("\"", entry.name, "\""));
  entry.compressed = archive.bytes.subspan(data, entry.packed);
  return entry;
}

/// Returns the entries of an archive whose writer was interrupted; empty if the last one states its size.
std::vector<ZipEntry> read_unfinished(const Archive& archive) {
  std::vector<ZipEntry> entries;
  for (uint64_t position = 0; archive.is(position, zip::kLocalHeaderSize, zip::kLocalHeader);) {
    ZipEntry entry;
    const Result<uint64_t> data =
        read_common(archive, position + 4, position + zip::kLocalHeaderSize, archive.bytes.size(), entry);
    if (!data) break;
    entry.compressed = archive.bytes.subspan(*data);
    entry.is_unfinished = entry.size == 0 && entry.method == zip::kDeflated;
    if (entry.is_unfinished) {
      entry.size = UINT64_MAX - 1;
      entries.push_back(std::move(entry));
      return entries;
    }
    if (entry.packed > entry.compressed.size()) break;
    entry.compressed = entry.compressed.first(entry.packed);
    position = *data + entry.packed;
    entries.push_back(std::move(entry));
  }
  return {};
}

Error bad_entry(const std::string& location, const char* what) {
  return fail(ErrorCode::kFormat, location, "the compressed data is damaged (", what, "); write the archive again");
}

/// Owns the zlib state.
struct Inflater {
  z_stream stream{};
  bool ready = inflateInit2(&stream, -MAX_WBITS) == Z_OK;
  Inflater() = default;
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream); }
};

/// Stops early, without checks, once `most` bytes are unpacked.
Result<std::vector<uint8_t>> inflate_entry(const ZipEntry& entry, const std::string& location, size_t most) {
  constexpr size_t kLeastRoom = size_t{64} << 10;
  Inflater inflater;
  if (!inflater.ready) return fail(ErrorCode::kInternal, location, "zlib did not start; free some memory");
  z_stream& stream = inflater.stream;
  std::span<const uint8_t> input = entry.compressed;
  std::vector<uint8_t> output;
  for (int status = Z_OK; status != Z_STREAM_END && output.size() < most;) {
    zip::refill(stream, input);
    // The buffer grows by what has been unpacked so far, to at most one byte past the claimed size, which is enough to
    // notice a longer stream.
    const size_t filled = output.size();
    const size_t room =
        std::min<uint64_t>(std::clamp<size_t>(filled, kLeastRoom, zip::kMostAtOnce), entry.size - filled + 1);
    output.resize(filled + room);
    stream.next_out = output.data() + filled;
    stream.avail_out = static_cast<uInt>(room);
    status = inflate(&stream, Z_NO_FLUSH);
    output.resize(filled + (room - stream.avail_out));
    if (status == Z_BUF_ERROR || (status == Z_OK && stream.avail_in == 0 && input.empty() && stream.avail_out != 0)) {
      if (entry.is_unfinished) return output;
      return bad_entry(location, "the stream has no end");
    }
    if (status != Z_OK && status != Z_STREAM_END) return bad_entry(location, "not a deflate stream");
    if (output.size() > entry.size) return bad_entry(location, "more bytes than the directory states");
  }
  output.resize(std::min(most, output.size()));
  return output;
}

}  // namespace

Result<std::vector<ZipEntry>> read_zip_directory(std::span<const uint8_t> bytes, const std::string& name) {
  const Archive archive{bytes, name};
  const Result<Directory> found = find_directory(archive);
  if (!found) {
    std::vector<ZipEntry> unfinished = read_unfinished(archive);
    return unfinished.empty() ? Result<std::vector<ZipEntry>>(found.error()) : std::move(unfinished);
  }
  const Directory& directory = *found;
  std::vector<ZipEntry> entries;
  std::set<std::string> names;
  uint64_t position = directory.offset;
  uint64_t compressed = 0;
  for (uint64_t i = 0; i < directory.count; ++i) {
    E2LF_ASSIGN_OR_RETURN(ZipEntry entry, read_entry(archive, position, directory.offset + directory.size));
    if (!names.insert(entry.name).second) {
      return fail(ErrorCode::kFormat, name, "\"", entry.name, "\" is in the archive twice; write it again");
    }
    // Entries that share bytes would let a small archive unpack to any size.
    compressed += entry.compressed.size();
    if (compressed > bytes.size()) return archive.damaged(position, "entries overlap");
    entries.push_back(std::move(entry));
  }
  return entries;
}

Result<std::vector<uint8_t>> unpack_zip_entry(const ZipEntry& entry, const std::string& location, size_t most) {
  std::vector<uint8_t> bytes;
  if (entry.method == zip::kStored) {
    const auto head = entry.compressed.first(std::min(most, entry.compressed.size()));
    bytes.assign(head.begin(), head.end());
  } else if (entry.method == zip::kDeflated) {
    E2LF_ASSIGN_OR_RETURN(bytes, inflate_entry(entry, location, most));
  } else {
    return fail(ErrorCode::kUnsupported, location, "zip compression method ", entry.method,
                " is not supported; store or deflate it");
  }
  if (entry.is_unfinished || most < std::numeric_limits<size_t>::max()) return bytes;
  if (bytes.size() != entry.size) return bad_entry(location, "another size than the directory states");
  if (crc32_z(0, bytes.data(), bytes.size()) != entry.crc) {
    return fail(ErrorCode::kInvalidValue, location, "the checksum does not match; copy the file again");
  }
  return bytes;
}

}  // namespace e2lf
