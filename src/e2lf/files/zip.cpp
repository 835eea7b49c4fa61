// SPDX-License-Identifier: MIT
// Reads zip archives; declared in zip.h.
#include "e2lf/files/zip.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>
#include <zlib.h>

#include "e2lf/base/result.h"
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

constexpr uint16_t kExtra64 = 1;           ///< id of the extra field with 64-bit sizes
constexpr uint32_t kIn64 = 0xFFFFFFFF;     ///< means "the value is in the zip64 record"
constexpr uint16_t kCountIn64 = 0xFFFF;    ///< the same for counts
constexpr uint16_t kVersion64 = 45;        ///< the version needed to extract
constexpr uint16_t kUtf8Names = 1U << 11;  ///< flag

}  // namespace
namespace {

template <typename T>
void put(std::vector<uint8_t>& bytes, T value) {
  for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

void append(std::vector<uint8_t>& bytes, const auto& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

uint32_t narrow(uint64_t value, bool is_wide) {
  return is_wide ? kIn64 : static_cast<uint32_t>(value);
}

/// Formats the records of one member.
class MemberRecords {
 public:
  MemberRecords(const Member& member, uint64_t zip64_from)
      : member_(member),
        has_wide_sizes_(member.size >= zip64_from || member.packed >= zip64_from),
        has_wide_offset_(member.offset >= zip64_from) {}

  void put_local_header(std::vector<uint8_t>& bytes) const {
    put<uint32_t>(bytes, kLocalHeader);
    put_common(bytes);
    const std::vector<uint8_t> extra = extra_field(/*with_offset=*/false);
    put<uint16_t>(bytes, static_cast<uint16_t>(extra.size()));
    append(bytes, member_.name);
    append(bytes, extra);
  }

  void put_directory_entry(std::vector<uint8_t>& bytes) const {
    put<uint32_t>(bytes, kDirectoryEntry);
    put<uint16_t>(bytes, kVersion64);  // made by
    put_common(bytes);
    const std::vector<uint8_t> extra = extra_field(has_wide_offset_);
    put<uint16_t>(bytes, static_cast<uint16_t>(extra.size()));
    put<uint16_t>(bytes, 0);  // comment length
    put<uint16_t>(bytes, 0);  // disk
    put<uint16_t>(bytes, 0);  // internal attributes
    put<uint32_t>(bytes, 0);  // external attributes
    put<uint32_t>(bytes, narrow(member_.offset, has_wide_offset_));
    append(bytes, member_.name);
    append(bytes, extra);
  }

 private:
  /// Appends the fields that both records share, from the version needed to the length of the name.
  void put_common(std::vector<uint8_t>& bytes) const {
    put<uint16_t>(bytes, has_wide_sizes_ || has_wide_offset_ ? kVersion64 : 20);
    put<uint16_t>(bytes, kUtf8Names);
    put<uint16_t>(bytes, member_.method);
    put<uint32_t>(bytes, 0x00210000);  // 1980-01-01 00:00, so that equal members give equal files
    put<uint32_t>(bytes, member_.crc);
    put<uint32_t>(bytes, narrow(member_.packed, has_wide_sizes_));
    put<uint32_t>(bytes, narrow(member_.size, has_wide_sizes_));
    put<uint16_t>(bytes, static_cast<uint16_t>(member_.name.size()));
  }

  [[nodiscard]] std::vector<uint8_t> extra_field(bool with_offset) const {
    std::vector<uint8_t> bytes;
    if (!has_wide_sizes_ && !with_offset) return bytes;
    put<uint16_t>(bytes, kExtra64);
    put<uint16_t>(bytes, static_cast<uint16_t>((has_wide_sizes_ ? 16 : 0) + (with_offset ? 8 : 0)));
    if (has_wide_sizes_) put<uint64_t>(bytes, member_.size);
    if (has_wide_sizes_) put<uint64_t>(bytes, member_.packed);
    if (with_offset) put<uint64_t>(bytes, member_.offset);
    return bytes;
  }

  const Member& member_;
  bool has_wide_sizes_, has_wide_offset_;
};

/// Appends the end record of zip64 and its locator.
void put_end64(std::vector<uint8_t>& bytes, uint64_t count, uint64_t size, uint64_t offset) {
  put<uint32_t>(bytes, kDirectoryEnd64);
  put<uint64_t>(bytes, kDirectoryEnd64Size - 12);
  put<uint16_t>(bytes, kVersion64);
  put<uint16_t>(bytes, kVersion64);
  put<uint64_t>(bytes, 0);      // this disk, the directory's disk
  put<uint64_t>(bytes, count);  // entries on this disk
  put<uint64_t>(bytes, count);
  put<uint64_t>(bytes, size);
  put<uint64_t>(bytes, offset);
  put<uint32_t>(bytes, kLocator64);
  put<uint32_t>(bytes, 0);
  put<uint64_t>(bytes, offset + size);
  put<uint32_t>(bytes, 1);  // disks
}

}  // namespace

std::vector<uint8_t> local_header(const Member& member, uint64_t zip64_from) {
  std::vector<uint8_t> bytes;
  MemberRecords(member, zip64_from).put_local_header(bytes);
  return bytes;
}

std::vector<uint8_t> directory(std::span<const Member> members, uint64_t offset, uint64_t zip64_from) {
  std::vector<uint8_t> bytes;
  for (const Member& member : members) MemberRecords(member, zip64_from).put_directory_entry(bytes);
  const uint64_t size = bytes.size();
  const bool is_wide = offset >= zip64_from || size >= zip64_from || members.size() >= kCountIn64;
  if (is_wide) put_end64(bytes, members.size(), size, offset);
  put<uint32_t>(bytes, kDirectoryEnd);
  put<uint32_t>(bytes, 0);  // this disk, the directory's disk
  put<uint16_t>(bytes, is_wide ? kCountIn64 : static_cast<uint16_t>(members.size()));
  put<uint16_t>(bytes, is_wide ? kCountIn64 : static_cast<uint16_t>(members.size()));
  put<uint32_t>(bytes, narrow(size, is_wide));
  put<uint32_t>(bytes, narrow(offset, is_wide));
  put<uint16_t>(bytes, 0);  // comment length
  return bytes;
}

}  // namespace e2lf::zip

namespace e2lf {
namespace {

/// Compresses to a raw deflate stream, as zip archives store it.
std::vector<uint8_t> deflate_bytes(std::span<const uint8_t> input) {
  z_stream stream{};
  const int started = deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  E2LF_REQUIRE(started == Z_OK, "zlib did not start");
  std::vector<uint8_t> output;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      const size_t taken = std::min<size_t>(input.size(), size_t{1} << 30);
      stream.next_in = const_cast<Bytef*>(input.data());
      stream.avail_in = static_cast<uInt>(taken);
      input = input.subspan(taken);
    }
    const size_t filled = output.size();
    const size_t room = std::clamp<size_t>(filled, size_t{64} << 10, size_t{1} << 30);
    output.resize(filled + room);
    stream.next_out = output.data() + filled;
    stream.avail_out = static_cast<uInt>(room);
    status = deflate(&stream, input.empty() ? Z_FINISH : Z_NO_FLUSH);
    output.resize(filled + (room - stream.avail_out));
  }
  deflateEnd(&stream);
  return output;
}

}  // namespace

void ZipWriter::add(const std::string& name, std::span<const uint8_t> bytes, bool compress) {
  E2LF_REQUIRE(name.size() <= 0xFFFF, "the name is too long for a zip archive");
  std::vector<uint8_t> packed;
  if (compress) packed = deflate_bytes(bytes);
  const std::span<const uint8_t> data = compress ? std::span<const uint8_t>(packed) : bytes;
  members_.push_back({.name = name,
                      .method = compress ? zip::kDeflated : zip::kStored,
                      .crc = static_cast<uint32_t>(crc32_z(0, bytes.data(), bytes.size())),
                      .packed = data.size(),
                      .size = bytes.size(),
                      .offset = archive_.size()});
  const std::vector<uint8_t> header = zip::local_header(members_.back(), zip64_from_);
  archive_.insert(archive_.end(), header.begin(), header.end());
  archive_.insert(archive_.end(), data.begin(), data.end());
}

std::vector<uint8_t> ZipWriter::finish() {
  const std::vector<uint8_t> directory = zip::directory(members_, archive_.size(), zip64_from_);
  archive_.insert(archive_.end(), directory.begin(), directory.end());
  return std::move(archive_);
}

namespace {

constexpr size_t kPeekSize = size_t{64} << 10;

/// An archive with its name. Positions must be checked with has() before get() reads them.
struct Archive {
  std::span<const uint8_t> bytes;
  const std::string& name;

  [[nodiscard]] bool has(uint64_t position, uint64_t size) const {
    return position <= bytes.size() && size <= bytes.size() - position;
  }
  template <typename T>
  [[nodiscard]] T get(uint64_t position) const {
    T value;
    std::memcpy(&value, bytes.data() + position, sizeof(T));
    return value;
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

struct EntrySizes {
  uint64_t size, compressed, offset;
};

/// Replaces the fields of a directory entry that are marked as 64-bit by the values of its zip64 extra field.
Result<void> read_extra64(const Archive& archive, uint64_t begin, uint64_t end, EntrySizes& sizes) {
  uint64_t* const wanted[] = {&sizes.size, &sizes.compressed, &sizes.offset};
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

/// Reads the directory entry at `position` and advances past it.
Result<ZipEntry> read_entry(const Archive& archive, uint64_t& position, uint64_t directory_end) {
  if (position + zip::kDirectoryEntrySize > directory_end || archive.get<uint32_t>(position) != zip::kDirectoryEntry) {
    return archive.damaged(position, "a directory entry is damaged");
  }
  const uint64_t name_begin = position + zip::kDirectoryEntrySize;
  const uint64_t name_end = name_begin + archive.get<uint16_t>(position + 28);
  const uint64_t extra_end = name_end + archive.get<uint16_t>(position + 30);
  const uint64_t entry_end = extra_end + archive.get<uint16_t>(position + 32);
  if (entry_end > directory_end) return archive.damaged(position, "a directory entry is too long");

  ZipEntry entry;
  entry.name.assign(archive.bytes.begin() + static_cast<ptrdiff_t>(name_begin),
                    archive.bytes.begin() + static_cast<ptrdiff_t>(name_end));
  entry.method = archive.get<uint16_t>(position + 10);
  entry.crc = archive.get<uint32_t>(position + 16);
  if ((archive.get<uint16_t>(position + 8) & 1U) != 0) {
    return fail(ErrorCode::kUnsupported, archive.name, "\"", entry.name,
                "\" is encrypted; store it without a password");
  }
  EntrySizes sizes{archive.get<uint32_t>(position + 24), archive.get<uint32_t>(position + 20),
                   archive.get<uint32_t>(position + 42)};
  E2LF_RETURN_IF_ERROR(read_extra64(archive, name_end, extra_end, sizes));
  entry.size = sizes.size;

  if (!archive.is(sizes.offset, zip::kLocalHeaderSize, zip::kLocalHeader)) {
    return archive.damaged(sizes.offset, "an entry has no header");
  }
  const uint64_t data = sizes.offset + zip::kLocalHeaderSize + archive.get<uint16_t>(sizes.offset + 26) +
                        archive.get<uint16_t>(sizes.offset + 28);
  if (!archive.has(data, sizes.compressed)) return archive.truncated(data, cat("\"", entry.name, "\""));
  entry.compressed = archive.bytes.subspan(data, sizes.compressed);
  position = entry_end;
  return entry;
}

/// Returns the entries of an archive whose writer was interrupted; empty if the last one states its size.
std::vector<ZipEntry> read_unfinished(const Archive& archive) {
  std::vector<ZipEntry> entries;
  for (uint64_t position = 0; archive.is(position, zip::kLocalHeaderSize, zip::kLocalHeader);) {
    const uint64_t name = position + zip::kLocalHeaderSize, extra = name + archive.get<uint16_t>(position + 26);
    const uint64_t data = extra + archive.get<uint16_t>(position + 28);
    EntrySizes sizes{archive.get<uint32_t>(position + 22), archive.get<uint32_t>(position + 18), 0};
    if (!archive.has(name, data - name) || !read_extra64(archive, extra, data, sizes)) break;
    ZipEntry entry;
    entry.method = archive.get<uint16_t>(position + 8);
    entry.crc = archive.get<uint32_t>(position + 14);
    const auto text = archive.bytes.subspan(name, extra - name);
    entry.name.assign(text.begin(), text.end());
    entry.is_unfinished = sizes.size == 0 && entry.method == zip::kDeflated;
    if (entry.is_unfinished) {
      entry.size = UINT64_MAX - 1;
      entry.compressed = archive.bytes.subspan(data);
      entries.push_back(std::move(entry));
      return entries;
    }
    if (!archive.has(data, sizes.compressed)) break;
    entry.size = sizes.size;
    entry.compressed = archive.bytes.subspan(data, sizes.compressed);
    entries.push_back(std::move(entry));
    position = data + sizes.compressed;
  }
  return {};
}

Error bad_entry(const std::string& location, const char* what) {
  return fail(ErrorCode::kFormat, location, "the compressed data is damaged (", what, "); write the archive again");
}

/// Owns the zlib state.
struct Inflater {
  z_stream stream{};
  bool ready = inflateInit2(&stream, -MAX_WBITS) == Z_OK;  // negative: no zlib header, as in zip archives
  Inflater() = default;
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream); }
};

/// Stops early, without checks, once `most` bytes are unpacked.
Result<std::vector<uint8_t>> inflate_entry(const ZipEntry& entry, const std::string& location, const ZipPeek& peek,
                                           size_t most = std::numeric_limits<size_t>::max()) {
  Inflater inflater;
  if (!inflater.ready) return fail(ErrorCode::kInternal, location, "zlib did not start; free some memory");
  z_stream& stream = inflater.stream;
  std::span<const uint8_t> input = entry.compressed;
  std::vector<uint8_t> output;
  bool peeked = !peek;
  for (int status = Z_OK; status != Z_STREAM_END && output.size() < most;) {
    if (stream.avail_in == 0) {
      const size_t taken = std::min<size_t>(input.size(), size_t{1} << 30);
      stream.next_in = const_cast<Bytef*>(input.data());
      stream.avail_in = static_cast<uInt>(taken);
      input = input.subspan(taken);
    }
    // The buffer grows by what has been unpacked so far, to at most one byte past the claimed size, which is enough to
    // notice a longer stream.
    const size_t filled = output.size();
    const size_t room =
        std::min<uint64_t>(std::clamp<size_t>(filled, kPeekSize, size_t{1} << 30), entry.size - filled + 1);
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
    if (!peeked && (output.size() >= kPeekSize || status == Z_STREAM_END)) {
      peeked = true;
      E2LF_RETURN_IF_ERROR(peek(output));
    }
  }
  return output;
}

Error unknown_method(const ZipEntry& entry, const std::string& location) {
  return fail(ErrorCode::kUnsupported, location, "zip compression method ", entry.method,
              " is not supported; store or deflate it");
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

Result<std::vector<uint8_t>> unpack_zip_head(const ZipEntry& entry, const std::string& location, size_t most) {
  if (entry.method == zip::kStored) {
    const auto head = entry.compressed.first(std::min(most, entry.compressed.size()));
    return std::vector<uint8_t>(head.begin(), head.end());
  }
  if (entry.method != zip::kDeflated) return unknown_method(entry, location);
  E2LF_ASSIGN_OR_RETURN(std::vector<uint8_t> head, inflate_entry(entry, location, {}, most));
  head.resize(std::min(most, head.size()));
  return head;
}

Result<std::vector<uint8_t>> unpack_zip_entry(const ZipEntry& entry, const std::string& location, const ZipPeek& peek) {
  std::vector<uint8_t> bytes;
  if (entry.method == zip::kStored) {
    bytes.assign(entry.compressed.begin(), entry.compressed.end());
  } else if (entry.method == zip::kDeflated) {
    E2LF_ASSIGN_OR_RETURN(bytes, inflate_entry(entry, location, peek));
  } else {
    return unknown_method(entry, location);
  }
  if (entry.is_unfinished) return bytes;
  if (bytes.size() != entry.size) return bad_entry(location, "another size than the directory states");
  if (crc32_z(0, bytes.data(), bytes.size()) != entry.crc) {
    return fail(ErrorCode::kInvalidValue, location, "the checksum does not match; copy the file again");
  }
  return bytes;
}

}  // namespace e2lf
