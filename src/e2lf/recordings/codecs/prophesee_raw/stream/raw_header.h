// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// The text in front of a RAW file's event words: lines "% key value", ended by "% end" or by the first line that is
/// not one of them. Keys that name the encoding: `format EVT3;height=720;width=1280`, `evt 3.0`, `geometry 1280x720`.
struct RawHeader {
  RecordingInfo info;      ///< format "evt2", "evt2.1", "evt3", "evt4", or empty when the header does not say
  std::string endianness;  ///< "little", "legacy" or empty: a hint only, files are known to be wrong
  size_t num_bytes = 0;    ///< where the event words begin
};

/// Parses the header at the front of `bytes`. `ended` = there is nothing behind them; otherwise kTruncated asks for
/// more. No header at all is an empty one. Fails with kFormat (keys that contradict each other, sizes that are no
/// numbers) and kUnsupported (an encoding that we do not read).
[[nodiscard]] Result<RawHeader> parse_raw_header(std::span<const uint8_t> bytes, bool ended, const std::string& name);

/// Reads the header off a source and applies what the caller was told: options.format and size stand in for what the
/// header leaves out. Fails like parse_raw_header(), with kFormat when the format stays unknown, and with kInvalidValue
/// when the options contradict the header.
[[nodiscard]] Result<RawHeader> read_raw_header(ByteSource& source, const OpenOptions& options);

enum class HeaderPlace { kNone, kIncomplete, kHere };

/// Whether a header that says how its events are encoded begins at the front of `bytes`, among event words. `ended` =
/// there is nothing behind them; otherwise kIncomplete asks for more.
[[nodiscard]] HeaderPlace find_raw_header(std::span<const uint8_t> bytes, bool ended);

/// Whether `head` begins with the header of a RAW recording (and not of a DAT file).
[[nodiscard]] bool is_raw_header(std::span<const uint8_t> head);

/// The header of a recording in info.format, ended by "% end". Keys of info.header are kept, but for those that name
/// encoding and size, which are made anew; keys that the vendor's software needs to open a file are added.
[[nodiscard]] std::string raw_header_text(const RecordingInfo& info);

}  // namespace e2lf::recordings
