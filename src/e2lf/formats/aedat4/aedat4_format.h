// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decompress.h"

namespace e2lf::formats {
using namespace recordings;
}

namespace e2lf::formats::aedat4 {

using recordings::Compression;

struct Stream {
  int32_t id = 0;
  std::string type;  ///< "EVTS", "TRIG", "FRME", "IMUS"
  size_t width = 0, height = 0;
  std::string source;  ///< name of the camera
  std::string output;  ///< name of the stream in its module, e.g. "events"
};

struct Header {
  Compression compression = Compression::kNone;
  uint64_t table_position = 0;  ///< offset of the end of the packets; 0 = unknown, at the end of the file
  std::vector<Stream> streams;
  size_t bytes = 0;  ///< offset of the packets
};

inline constexpr std::string_view kVersionLine = "#!AER-DAT4.0\r\n";

/// Largest plausible header, in bytes.
inline constexpr size_t kMaxHeaderBytes = size_t{1} << 22;

/// Returns the size of the header in bytes from its first 18 bytes, or nothing if it is not an AEDAT 4 file.
[[nodiscard]] std::optional<size_t> header_size(std::span<const uint8_t> head);

/// Parses the header from bytes that contain all of it. Fails with kFormat.
[[nodiscard]] Result<Header> parse_header(std::span<const uint8_t> bytes, const std::string& name);

/// Parses the streams in the header's XML: nodes /mainloop/.../outInfo/<id>/ with typeIdentifier, sizeX, sizeY and
/// source.
[[nodiscard]] std::vector<Stream> parse_streams(std::string_view xml);

/// Appends the events of a decompressed EVTS packet. Returns false, without appending any, if it is not one or is
/// truncated. Negative coordinates become 65535, which is outside any sensor.
[[nodiscard]] bool append_events(std::span<const uint8_t> packet, EventColumns& events);

/// Appends the external signals of a decompressed TRIG packet. Returns false if it is not one.
[[nodiscard]] bool append_triggers(std::span<const uint8_t> packet, std::vector<Trigger>& triggers);

}  // namespace e2lf::formats::aedat4
