// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"

namespace e2lf {

/// A tensor of a .safetensors file: an array of numbers, whose type may also be "bf16".
using Tensor = NpyArray;

/// Converts the values to "bf16", rounded to nearest with ties to even. The relative error is at most 2^-8.
[[nodiscard]] Tensor make_bfloat16_tensor(std::vector<size_t> shape, std::span<const float> values);

/// Returns the name of the type in .safetensors files, such as "F32" or "BF16".
[[nodiscard]] std::string type_name(const Tensor& tensor);

struct Safetensors {
  std::map<std::string, Tensor> tensors;
  std::map<std::string, std::string> metadata;  ///< "__metadata__"

  /// Returns the tensor of that name. Fails with kNotFound and suggests the nearest name; `file` is the location in
  /// errors.
  [[nodiscard]] Result<const Tensor*> find(const std::string& name, const std::string& file) const;
};

/// Decodes a .safetensors file in memory (8-byte header length, JSON header, data). Every offset, shape and type is
/// checked against the file. Fails with kTruncated if the header or a tensor extends beyond its end, and with kFormat
/// if the header violates the format (overlaps, holes, or sizes that do not match the shape). The message names file
/// and tensor.
[[nodiscard]] Result<Safetensors> decode_safetensors(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] std::vector<uint8_t> encode_safetensors(const Safetensors& file);

[[nodiscard]] Result<Safetensors> read_safetensors(const std::filesystem::path& path);
/// Reads the metadata, the types and shapes of the tensors, and the values of the tensor with this name, if it is
/// there. The others have no bytes.
[[nodiscard]] Result<Safetensors> read_safetensors_header(const std::filesystem::path& path,
                                                          const std::string& tensor_name);
[[nodiscard]] Result<void> write_safetensors(const std::filesystem::path& path, const Safetensors& file);

}  // namespace e2lf
