// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::text {

/// Events as lines of text. We write two orders:
///   csv: x,y,p,t   t in whole microseconds; first line "%geometry:W,H" when the size is known
///   txt: t x y p   t in seconds with six decimals; first line "W H" when the size is known
/// A reader takes the columns in any order and unit (table/layout.h), other separators, comments and names above them,
/// any ends of lines, and polarities in words. A line that is no event is dropped (kBadRecord); where most are none,
/// opening or reading fails with kFormat.

/// Whether the first lines are rows of numbers.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_csv(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_txt(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);

[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_csv(std::unique_ptr<ByteSink> sink,
                                                                  const RecordingInfo& info);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_txt(std::unique_ptr<ByteSink> sink,
                                                                  const RecordingInfo& info);

}  // namespace e2lf::recordings::text
