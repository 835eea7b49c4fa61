// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>
#include <zlib.h>

#include "e2lf/base/result.h"

/// Zip archives (PKWARE APPNOTE 6.3), as numpy stores arrays in them.
namespace e2lf::zip {

inline constexpr uint16_t kStored = 0;
inline constexpr uint16_t kDeflated = 8;

/// A member of an archive, as its local header and its entry in the directory describe it.
struct Member {
  std::string name;
  uint16_t method = kStored;
  uint32_t crc = 0;
  uint64_t packed = 0, size = 0;
  uint64_t offset = 0;  ///< position of its local header in the archive
};

/// Returns the local header of a member in zip64 form, whose length depends on the name alone.
[[nodiscard]] std::vector<uint8_t> local_header(const Member& member);

/// Returns the directory of an archive, which begins at `offset`, and its end records.
[[nodiscard]] std::vector<uint8_t> directory(std::span<const Member> members, uint64_t offset);

/// Compresses to a raw deflate stream piece by piece.
class Deflater {
 public:
  using Sink = std::function<Result<void>(std::span<const uint8_t> packed)>;

  explicit Deflater(int level);
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream_); }

  /// Compresses the next bytes and passes what zlib returns with this `flush` to `sink`. Fails as the sink does.
  Result<void> add(std::span<const uint8_t> bytes, int flush, const Sink& sink);

 private:
  z_stream stream_{};
};

}  // namespace e2lf::zip

namespace e2lf {

/// One file of a zip archive as its directory lists it; `size` is claimed. `compressed` points into the archive.
struct ZipEntry : zip::Member {
  std::span<const uint8_t> compressed;
  bool is_unfinished = false;  ///< whether the archive was not finished and ends within this file
};

/// Returns the entries of an archive, with or without zip64. An archive without a directory is read from its start if
/// its last entry does not state its size yet, because its writer was interrupted. `name` is the location in errors.
/// Fails with kFormat (not a zip archive, a duplicate entry, or overlapping entries), kTruncated (a part beyond the
/// end) and kUnsupported (several disks, or encryption).
[[nodiscard]] Result<std::vector<ZipEntry>> read_zip_directory(std::span<const uint8_t> archive,
                                                               const std::string& name);

/// Unpacks one entry, or up to `most` bytes of it, whose size and checksum are then not checked. Memory grows with the
/// data that are actually unpacked and does not depend on the size in the directory. Fails with kUnsupported (another
/// compression method), kFormat (a damaged stream, or another size than claimed) and kInvalidValue (a wrong checksum).
[[nodiscard]] Result<std::vector<uint8_t>> unpack_zip_entry(const ZipEntry& entry, const std::string& location,
                                                            size_t most = std::numeric_limits<size_t>::max());

/// Builds an archive in memory, of which the caller may take the beginning at any time.
class ZipWriter {
 public:
  void add(const std::string& name, std::span<const uint8_t> bytes, bool compress);
  /// Lists a member that the caller writes itself after what was taken, and returns its offset.
  uint64_t add_written(zip::Member member);

  /// Returns the bytes of the archive that were not taken yet; finish() adds the directory.
  [[nodiscard]] std::vector<uint8_t> take();
  [[nodiscard]] std::vector<uint8_t> finish();

 private:
  std::vector<zip::Member> members_;
  std::vector<uint8_t> archive_;  ///< from byte `taken_` on
  uint64_t taken_ = 0;
};

}  // namespace e2lf
