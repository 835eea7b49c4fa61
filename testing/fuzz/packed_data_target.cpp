// SPDX-License-Identifier: MIT
// The target of packed training data: the input is a file.
#include "e2lf/learn/data/packed_data.h"
#include "require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using e2lf::fuzz::require;
  auto file = e2lf::decode_safetensors({data, size}, "input");
  if (!file) return 0;
  const size_t tensors = file->tensors.size();
  const auto packed = e2lf::learn::sort_packed_data(std::move(*file), "input");
  if (!packed) {
    require(!packed.error().message.empty(), "an error says what is wrong");
    return 0;
  }
  size_t placed = packed->light_fields.size() + packed->textures.size();
  for (const auto& [name, pixels, disparity] : packed->light_fields) {
    if (!disparity.shape.empty()) {
      ++placed;
      require(disparity.bytes.size() == 4 * sizeof(float) * pixels.shape[2] * pixels.shape[3],
              "disparities are those of four views of the size");
    }
    require(pixels.shape.size() == 4 && pixels.bytes.size() == 64 * pixels.shape[2] * pixels.shape[3],
            "a light field has 8x8 views of its size");
  }
  require(placed == tensors, "every tensor has its place");
  for (const auto& [name, pixels, disparity] : packed->textures) {
    require(pixels.shape.size() == 2 && pixels.bytes.size() == pixels.shape[0] * pixels.shape[1],
            "a photograph has its pixels");
  }
  return 0;
}
