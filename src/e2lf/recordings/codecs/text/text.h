// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::text {

/// Events as lines of text. Two orders are written:
///   csv: x,y,p,t   t in integral microseconds; first line "%geometry:W,H" if the size is known
///   txt: t x y p   t in seconds with six decimals; first line "W H" if the size is known
/// Readers accept columns in any order and unit (table/layout.h), other separators, comments and names above the
/// columns, any line endings, and polarities in words. Lines that are not events are dropped (kBadRecord); if most are
/// not, opening or reading fails with kFormat.

/// Returns whether the first lines are rows of numbers.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

[[nodiscard]] Result<ReaderPtr> open_csv(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<ReaderPtr> open_txt(SourcePtr source, const OpenOptions& options);

[[nodiscard]] Result<WriterPtr> create_csv(SinkPtr sink, const RecordingInfo& info);
[[nodiscard]] Result<WriterPtr> create_txt(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::recordings::text
