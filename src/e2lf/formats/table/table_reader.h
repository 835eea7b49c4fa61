// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::table {

/// Returns a reader of the events of a table, whose times may wrap around at 32 bits of `unit`. `name` is the location,
/// and `zero_us` the time of a row of zeros. Runs of such rows after later times are the unused rest of a table: they
/// are dropped (kZeros).
[[nodiscard]] ReaderPtr make_table_reader(BlocksPtr blocks, TimeUnit unit, RecordingInfo info, const std::string& name,
                                          const OpenOptions& options, TriggersPtr triggers = {}, int64_t zero_us = 0);

}  // namespace e2lf::recordings::table
