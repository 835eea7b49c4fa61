// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Bytes of an element of the numpy code ("b1", "i1".."i8", "u1".."u8", "f2", "f4", "f8") or of "bf16"; 0 for others.
[[nodiscard]] size_t element_size(std::string_view code);

/// Little-endian elements of that code as float32. `name` is the location in errors. Fails with kUnsupported for an
/// unknown code.
[[nodiscard]] Result<std::vector<float>> elements_to_float(std::string_view code, std::span<const uint8_t> bytes,
                                                           const std::string& name);

/// The same as int32. Fails with kInvalidValue at the first value that does not fit or is not whole.
[[nodiscard]] Result<std::vector<int32_t>> elements_to_int32(std::string_view code, std::span<const uint8_t> bytes,
                                                             const std::string& name);

/// The product of the extents and `item_size`. Fails with kFormat where it does not fit a size_t, zero extents or not.
[[nodiscard]] Result<size_t> checked_byte_size(std::span<const size_t> shape, size_t item_size,
                                               const std::string& location);

}  // namespace e2lf
