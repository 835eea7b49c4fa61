// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings::table {

/// Unwraps times of a signed or unsigned 32-bit clock that counts `unit`. A decrease by more than three quarters of its
/// range is a wrap (DecodeSummary::time_loops), and an increase by as much after a wrap is a late event. Other times
/// are unchanged. Seeking behind a wrap goes to the first block.
[[nodiscard]] std::unique_ptr<EventBlocks> make_unwrapped(std::unique_ptr<EventBlocks> blocks, TimeUnit unit);

}  // namespace e2lf::recordings::table
