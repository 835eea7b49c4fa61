// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Returns the size in bytes of an element with this numpy type code ("b1", "i1".."i8", "u1".."u8", "f2", "f4", "f8")
/// or "bf16", and 0 for other codes.
[[nodiscard]] size_t element_size(std::string_view code);

/// Converts little-endian elements of that type to float32. `name` is the location in errors. Fails with kUnsupported
/// for an unknown code.
[[nodiscard]] Result<std::vector<float>> elements_to_float(std::string_view code, std::span<const uint8_t> bytes,
                                                           const std::string& name);

/// Converts little-endian elements of that type to int32. Fails with kInvalidValue at the first value that is not whole
/// or does not fit, and with kUnsupported for an unknown code.
[[nodiscard]] Result<std::vector<int32_t>> elements_to_int32(std::string_view code, std::span<const uint8_t> bytes,
                                                             const std::string& name);

/// Returns the product of the extents and `item_size`. Fails with kFormat if it does not fit into a size_t, where
/// extents of zero are counted as one so that they do not hide an overflow.
[[nodiscard]] Result<size_t> checked_byte_size(std::span<const size_t> shape, size_t item_size,
                                               const std::string& location);

}  // namespace e2lf
