// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// A numeric array of a MATLAB file older than version 7.3, in column-major order.
struct MatArray {
  std::string name;
  /// The numpy code ("i2", "f8") of the MATLAB class (MAT-File Format, version 5, table "Array Types"), of
  /// floating-point numbers and integers of 8 to 32 bits; empty for others.
  std::string class_type;
  bool complex = false;
  bool logical = false;  ///< true if the uint8 array is a logical one, whose values are true (1) and false (0)
  std::vector<size_t> extents;
  std::string type;  ///< the code of the stored numbers ("Data Types"), which may be smaller if all of them fit
  std::span<const uint8_t> data;  ///< little-endian; points into `inflated` or into the bytes of the file
  std::vector<uint8_t> inflated;  ///< holds the variable if the file compresses it
};

/// Finds the variable `name` in the bytes of a file, and appends the names of those before it to `others`, at most a
/// thousand. The checksum of compressed data is verified, and `max_bytes` limits their inflated size. Fails with
/// kNotFound, kTruncated, kFormat and kUnsupported (big-endian or too large).
[[nodiscard]] Result<MatArray> find_mat_array(std::span<const uint8_t> bytes, const std::string& name,
                                              uint64_t max_bytes, const std::string& location,
                                              std::vector<std::string>& others);

}  // namespace e2lf
