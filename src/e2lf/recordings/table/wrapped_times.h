// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings::table {

/// Blocks in their order whose times are those of a clock of 32 bits that counts `unit`, with a sign or without, and
/// may wrap: a fall of more than three quarters of its circle is a wrap (DecodeSummary::time_loops), a rise of so much
/// behind it a straggler. Other times stay as they are. A seek behind a wrap goes to the first block.
[[nodiscard]] std::unique_ptr<EventBlocks> make_unwrapped(std::unique_ptr<EventBlocks> blocks, TimeUnit unit);

}  // namespace e2lf::recordings::table
