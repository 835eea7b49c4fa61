// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::recordings {

/// Returns the number of polarities that are ON; each is 0 or 1.
[[nodiscard]] uint64_t count_on(std::span<const uint8_t> p);

}  // namespace e2lf::recordings
