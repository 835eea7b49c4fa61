// SPDX-License-Identifier: MIT
// Writes zip archives; declared in zip.h.
#include <algorithm>
#include <zlib.h>

#include "e2lf/base/contract.h"
#include "e2lf/files/zip.h"

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
