// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

struct RawEncoding {
  const char* codec;    ///< the name in e2lf
  const char* format;   ///< value of the key `format`
  const char* version;  ///< value of the key `evt`
};
inline constexpr std::array<RawEncoding, 4> kRawEncodings = {
    {{"evt2", "EVT2", "2.0"}, {"evt2.1", "EVT21", "2.1"}, {"evt3", "EVT3", "3.0"}, {"evt4", "EVT4", "4.0"}}};

/// The text before the event words of a RAW file (PercentHeader). Keys that state the encoding: `format
/// EVT3;height=720;width=1280`, `evt 3.0`, `geometry 1280x720`.
struct RawHeader {
  RecordingInfo info;      ///< format "evt2", "evt2.1", "evt3" or "evt4", or empty if the header does not state it
  std::string endianness;  ///< "little", "legacy" or empty; only a hint, since files are known to be wrong
  size_t num_bytes = 0;    ///< offset of the event words
};

/// Parses the header at the start of `bytes`. If not `ended`, more bytes may follow, and kTruncated requests them. A
/// missing header is an empty one. Fails with kFormat (keys that contradict each other, or sizes that are not numbers)
/// and kUnsupported (an encoding that cannot be read).
[[nodiscard]] Result<RawHeader> parse_raw_header(std::span<const uint8_t> bytes, bool ended, const std::string& name);

/// Reads the header from a source and applies the options: options.format and size replace what the header omits. Fails
/// as parse_raw_header() does, with kFormat if the format remains unknown, and with kInvalidValue if the options
/// contradict the header.
[[nodiscard]] Result<RawHeader> read_raw_header(ByteSource& source, const OpenOptions& options);

/// Returns the header of a recording in info.format, which ends with "% end". Keys of info.header are kept, except
/// those of encoding and size, which are written anew. Keys that the vendor's software requires are added.
[[nodiscard]] std::string raw_header_text(const RecordingInfo& info);

}  // namespace e2lf::recordings
