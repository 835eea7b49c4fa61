// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// How a number is stored (MAT-File Format, version 5, table "Data Types").
enum class MatStorage : uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kSingle = 7,
  kDouble = 9,
};

/// What a number is to MATLAB ("Array Types"); it may be stored as a smaller type where all values fit.
enum class MatClass : uint8_t {
  kDouble = 6,
  kSingle = 7,
  kInt8 = 8,
  kUint8 = 9,
  kInt16 = 10,
  kUint16 = 11,
  kInt32 = 12,
  kUint32 = 13,
};

/// A numeric array of a MATLAB file before version 7.3, column-major.
struct MatArray {
  uint8_t array_class = 0;  ///< a MatClass, or another that is not handled here
  bool complex = false;
  bool logical = false;  ///< a uint8 to MATLAB's file, true (1) or false (0) to MATLAB
  std::vector<size_t> extents;
  uint32_t storage = 0;           ///< a MatStorage
  std::span<const uint8_t> data;  ///< little-endian; in `inflated`, or in the bytes of the file
  std::vector<uint8_t> inflated;  ///< holds the variable where the file compresses it
};

/// Finds variable `name` in the bytes of a file. Compressed data is checked against its checksum, and `max_bytes` is
/// the most it may inflate to. Fails with kNotFound, kTruncated, kFormat and kUnsupported (big-endian, too large).
[[nodiscard]] Result<MatArray> find_mat_array(std::span<const uint8_t> bytes, const std::string& name,
                                              uint64_t max_bytes, const std::string& location);

/// The names of the variables in a file, a thousand at most; data are not read. Fails with kTruncated (or no such file)
/// and kUnsupported (big-endian).
[[nodiscard]] Result<std::vector<std::string>> mat_variables(const std::filesystem::path& path);

/// An array to write, column-major. One of its class's own storage: kSingle for kSingle.
struct MatVariable {
  std::string name;
  MatClass array_class = MatClass::kSingle;
  std::vector<size_t> extents;    ///< two at least
  std::span<const uint8_t> data;  ///< little-endian
};

/// A MATLAB file of version 6 (the format of version 5, nothing compressed), as `save -v6` makes it. Fails with
/// kUnsupported where a variable has 2 GiB or more, which the format cannot hold. Extents that `data` does not fill
/// break the contract.
[[nodiscard]] Result<std::vector<uint8_t>> encode_mat(std::span<const MatVariable> variables,
                                                      const std::string& location);

}  // namespace e2lf
