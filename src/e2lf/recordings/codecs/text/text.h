// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::text {

/// Events as lines of text, in one of two orders:
///   csv: x,y,p,t   t in whole microseconds; first line "%geometry:W,H" when the size is known
///   txt: t x y p   t in seconds with six decimals; first line "W H" when the size is known
/// A reader also takes other separators (comma, semicolon, blanks), lines of comment (# or %), a line of column names
/// in any order, and polarities -1 / 1. A line that is not four numbers is dropped (kBadRecord).

[[nodiscard]] bool detect_csv(std::span<const uint8_t> head);
[[nodiscard]] bool detect_txt(std::span<const uint8_t> head);

[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_csv(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_txt(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);

[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_csv(std::unique_ptr<ByteSink> sink,
                                                                  const RecordingInfo& info);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_txt(std::unique_ptr<ByteSink> sink,
                                                                  const RecordingInfo& info);

}  // namespace e2lf::recordings::text
