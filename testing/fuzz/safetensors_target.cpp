// SPDX-License-Identifier: MIT
// The target of .safetensors: the input is a file.
#include "e2lf/files/safetensors.h"
#include "require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using e2lf::fuzz::require;
  const auto file = e2lf::decode_safetensors({data, size}, "input");
  if (!file) return 0;
  for (const auto& [name, tensor] : file->tensors) {
    const auto values = tensor.to_float(name);
    require(!values || values->size() == tensor.num_elements(), "a tensor has as many values as its shape says");
  }
  const auto back = e2lf::decode_safetensors(e2lf::encode_safetensors(*file), "encoded");
  require(back.ok() && back->tensors.size() == file->tensors.size() && back->metadata == file->metadata,
          "a file comes back as encoded");
  for (const auto& [name, tensor] : file->tensors) {
    const auto& other = back->tensors.at(name);
    require(other.type == tensor.type && other.shape == tensor.shape && other.bytes == tensor.bytes,
            "a tensor comes back as encoded");
  }
  return 0;
}
