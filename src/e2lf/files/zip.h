// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// One file of a zip archive as its directory lists it; `compressed` points into the archive.
struct ZipEntry {
  std::string name;
  uint16_t method = 0;  ///< 0 = stored, 8 = deflated
  uint32_t crc = 0;
  uint64_t size = 0;  ///< decompressed, as claimed
  std::span<const uint8_t> compressed;
};

/// The entries of an archive (zip64 too). `name` goes into errors. Fails with kFormat (no zip, an entry named twice,
/// entries that overlap), kTruncated (a part beyond the end) and kUnsupported (several disks, encryption).
[[nodiscard]] Result<std::vector<ZipEntry>> read_zip_directory(std::span<const uint8_t> archive,
                                                               const std::string& name);

/// Looks at the first bytes of an entry while it is unpacked (at least 64 KiB or all of it); an error stops the work.
using ZipPeek = std::function<Result<void>(std::span<const uint8_t> head)>;

/// Unpacks one entry; memory grows with what really comes out, never on the word of the directory. Fails with
/// kUnsupported (another compression method), kFormat (a damaged stream, more or fewer bytes than claimed) and
/// kInvalidValue (a checksum that does not match).
[[nodiscard]] Result<std::vector<uint8_t>> unpack_zip_entry(const ZipEntry& entry, const std::string& location,
                                                            const ZipPeek& peek = {});

/// The first bytes of an entry, `most` of them or all there are. What comes after is neither unpacked nor checked.
/// Fails as unpack_zip_entry does, but for the checksum and the size.
[[nodiscard]] Result<std::vector<uint8_t>> unpack_zip_head(const ZipEntry& entry, const std::string& location,
                                                           size_t most);

/// Builds an archive in memory.
class ZipWriter {
 public:
  /// Sizes, offsets and counts from `zip64_from` on are written in zip64 form (a smaller one is for tests).
  explicit ZipWriter(uint64_t zip64_from = 0xFFFFFFFF) : zip64_from_(zip64_from) {}

  void add(const std::string& name, std::span<const uint8_t> bytes, bool compress);
  [[nodiscard]] std::vector<uint8_t> finish();

 private:
  uint64_t zip64_from_;
  size_t count_ = 0;
  std::vector<uint8_t> archive_;
  std::vector<uint8_t> directory_;
};

}  // namespace e2lf
