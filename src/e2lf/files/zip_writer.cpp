// SPDX-License-Identifier: MIT
#include <algorithm>
#include <zlib.h>

#include "e2lf/base/contract.h"
#include "e2lf/files/zip.h"
#include "e2lf/files/zip_format.h"

namespace e2lf {
namespace {

template <typename T>
void put(std::vector<uint8_t>& bytes, T value) {
  for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

void append(std::vector<uint8_t>& bytes, const auto& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

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
  const uint64_t offset = archive_.size();
  const bool wide_sizes = bytes.size() >= zip64_from_ || data.size() >= zip64_from_;
  const bool wide_offset = offset >= zip64_from_;
  const auto narrow = [](uint64_t value, bool wide) { return wide ? zip::kIn64 : static_cast<uint32_t>(value); };

  // The fields that the local header and the directory entry share, from the version needed to the two sizes.
  std::vector<uint8_t> common;
  put<uint16_t>(common, wide_sizes || wide_offset ? zip::kVersion64 : 20);
  put<uint16_t>(common, zip::kUtf8Names);
  put<uint16_t>(common, compress ? zip::kDeflated : zip::kStored);
  put<uint32_t>(common, 0x00210000);  // 1980-01-01 00:00, so that equal arrays give equal files
  put<uint32_t>(common, static_cast<uint32_t>(crc32_z(0, bytes.data(), bytes.size())));
  put<uint32_t>(common, narrow(data.size(), wide_sizes));
  put<uint32_t>(common, narrow(bytes.size(), wide_sizes));
  put<uint16_t>(common, static_cast<uint16_t>(name.size()));

  const auto put_extra = [&](std::vector<uint8_t>& target, bool with_offset) {
    if (!wide_sizes && !with_offset) return;
    put<uint16_t>(target, zip::kExtra64);
    put<uint16_t>(target, static_cast<uint16_t>((wide_sizes ? 16 : 0) + (with_offset ? 8 : 0)));
    if (wide_sizes) put<uint64_t>(target, bytes.size());
    if (wide_sizes) put<uint64_t>(target, data.size());
    if (with_offset) put<uint64_t>(target, offset);
  };
  std::vector<uint8_t> local_extra, directory_extra;
  put_extra(local_extra, false);
  put_extra(directory_extra, wide_offset);

  put<uint32_t>(archive_, zip::kLocalHeader);
  append(archive_, common);
  put<uint16_t>(archive_, static_cast<uint16_t>(local_extra.size()));
  append(archive_, name);
  append(archive_, local_extra);
  append(archive_, data);

  put<uint32_t>(directory_, zip::kDirectoryEntry);
  put<uint16_t>(directory_, zip::kVersion64);  // made by
  append(directory_, common);
  put<uint16_t>(directory_, static_cast<uint16_t>(directory_extra.size()));
  put<uint16_t>(directory_, 0);  // comment length
  put<uint16_t>(directory_, 0);  // disk
  put<uint16_t>(directory_, 0);  // internal attributes
  put<uint32_t>(directory_, 0);  // external attributes
  put<uint32_t>(directory_, narrow(offset, wide_offset));
  append(directory_, name);
  append(directory_, directory_extra);
  ++count_;
}

std::vector<uint8_t> ZipWriter::finish() {
  const uint64_t offset = archive_.size();
  const uint64_t size = directory_.size();
  const bool wide = offset >= zip64_from_ || size >= zip64_from_ || count_ >= zip::kCountIn64;
  append(archive_, directory_);
  if (wide) {
    const uint64_t end64 = archive_.size();
    put<uint32_t>(archive_, zip::kDirectoryEnd64);
    put<uint64_t>(archive_, zip::kDirectoryEnd64Size - 12);
    put<uint16_t>(archive_, zip::kVersion64);
    put<uint16_t>(archive_, zip::kVersion64);
    put<uint32_t>(archive_, 0);  // this disk
    put<uint32_t>(archive_, 0);  // the directory's disk
    put<uint64_t>(archive_, count_);
    put<uint64_t>(archive_, count_);
    put<uint64_t>(archive_, size);
    put<uint64_t>(archive_, offset);
    put<uint32_t>(archive_, zip::kLocator64);
    put<uint32_t>(archive_, 0);
    put<uint64_t>(archive_, end64);
    put<uint32_t>(archive_, 1);  // disks
  }
  put<uint32_t>(archive_, zip::kDirectoryEnd);
  put<uint32_t>(archive_, 0);  // this disk, the directory's disk
  put<uint16_t>(archive_, wide ? zip::kCountIn64 : static_cast<uint16_t>(count_));
  put<uint16_t>(archive_, wide ? zip::kCountIn64 : static_cast<uint16_t>(count_));
  put<uint32_t>(archive_, wide ? zip::kIn64 : static_cast<uint32_t>(size));
  put<uint32_t>(archive_, wide ? zip::kIn64 : static_cast<uint32_t>(offset));
  put<uint16_t>(archive_, 0);  // comment length
  return std::move(archive_);
}

}  // namespace e2lf
