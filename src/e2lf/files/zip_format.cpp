// SPDX-License-Identifier: MIT
#include "e2lf/files/zip_format.h"

#include <algorithm>
#include <zlib.h>

#include "e2lf/base/contract.h"
#include "e2lf/files/zip.h"

namespace e2lf::zip {
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

}  // namespace e2lf
