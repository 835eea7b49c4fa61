// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::recordings {

/// Triggers of a recording whose format cannot hold them are stored in <name>_triggers.csv beside <name>.<extension>: a
/// header line, and one line "p,id,t" per trigger (t in microseconds). They may be in any order and are held in memory.

[[nodiscard]] std::filesystem::path side_trigger_path(const std::filesystem::path& recording);

/// Opens the triggers beside a recording, or beside the file that it is a link to. Returns null if there is no such
/// file, or if `recording` is empty. Lines that cannot be read are counted in the reader's summary (kBadRecord). Fails
/// with kIo, and with kFormat if the file does not begin with the names of the columns.
[[nodiscard]] Result<BlocksPtr> open_side_triggers(const std::filesystem::path& recording);

/// Returns the triggers in the text of a source.
[[nodiscard]] BlocksPtr make_side_triggers(SourcePtr source);

}  // namespace e2lf::recordings
