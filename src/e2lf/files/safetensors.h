// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// A tensor of a .safetensors file: row-major little-endian bytes.
struct Tensor {
  std::string type;  ///< "F32", "F16", "BF16", "F64", "U8", "I8", "I16", "I32", "I64", "BOOL"
  std::vector<size_t> shape;
  std::vector<uint8_t> bytes;

  [[nodiscard]] size_t num_elements() const;

  /// The elements as float32, converted from any of the types. `name` is the location in errors.
  [[nodiscard]] Result<std::vector<float>> to_float(const std::string& name) const;
};

[[nodiscard]] Tensor make_tensor(std::vector<size_t> shape, std::span<const float> values);
[[nodiscard]] Tensor make_tensor(std::vector<size_t> shape, std::span<const uint8_t> values);

/// The values in 16 bits, "BF16": rounded to the nearest, ties to even. Relative errors are at most 2^-8.
[[nodiscard]] Tensor make_bfloat16_tensor(std::vector<size_t> shape, std::span<const float> values);

struct Safetensors {
  std::map<std::string, Tensor> tensors;
  std::map<std::string, std::string> metadata;  ///< "__metadata__"

  /// The tensor of that name. Fails with kNotFound and the nearest name; `file` is the location in errors.
  [[nodiscard]] Result<const Tensor*> find(const std::string& name, const std::string& file) const;
};

/// Decodes a .safetensors file in memory (8-byte header length, JSON header, data). Every offset, shape and type is
/// checked against the file: kTruncated for a header or tensor beyond its end, kFormat for a header that is not what
/// the format says (overlaps, holes, sizes that do not match the shape), with file and tensor in the message.
[[nodiscard]] Result<Safetensors> decode_safetensors(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] std::vector<uint8_t> encode_safetensors(const Safetensors& file);

[[nodiscard]] Result<Safetensors> read_safetensors(const std::filesystem::path& path);
[[nodiscard]] Result<void> write_safetensors(const std::filesystem::path& path, const Safetensors& file);

}  // namespace e2lf
