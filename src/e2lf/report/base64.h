// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace e2lf::report {

/// Encodes bytes in Base64 (RFC 4648), padded with "=".
[[nodiscard]] std::string base64(std::span<const uint8_t> bytes);

}  // namespace e2lf::report
