// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/io/decompress.h"

namespace e2lf::recordings::aedat4 {

using recordings::Compression;

struct Stream {
  int32_t id = 0;
  std::string type;  ///< "EVTS", "TRIG", "FRME", "IMUS"
  size_t width = 0, height = 0;
  std::string source;  ///< the camera
  std::string output;  ///< what its module calls it, as "events"
};

struct Header {
  Compression compression = Compression::kNone;
  uint64_t table_position = 0;  ///< where packets end; 0 = unknown, at the end of the file
  std::vector<Stream> streams;
  size_t bytes = 0;  ///< where the packets begin
};

inline constexpr std::string_view kVersionLine = "#!AER-DAT4.0\r\n";

/// Largest header that is believed, in bytes.
inline constexpr size_t kMaxHeaderBytes = size_t{1} << 22;

/// How many bytes of the file the header takes, from its first 18; nothing when it is no AEDAT 4 file.
[[nodiscard]] std::optional<size_t> header_size(std::span<const uint8_t> head);

/// Reads the header from bytes that hold it whole. Fails with kFormat.
[[nodiscard]] Result<Header> parse_header(std::span<const uint8_t> bytes, const std::string& name);

/// The streams in the header's XML: nodes /mainloop/.../outInfo/<id>/ with typeIdentifier, sizeX, sizeY and source.
[[nodiscard]] std::vector<Stream> parse_streams(std::string_view xml);

}  // namespace e2lf::recordings::aedat4
