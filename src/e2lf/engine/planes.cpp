// SPDX-License-Identifier: MIT
#include "e2lf/engine/planes.h"

#include <algorithm>

#include "e2lf/engine/pack.h"

namespace e2lf::engine {
namespace {

// The number of pixels transposed at a time, such that a line of the row's channels and a line of each plane fit into
// the first-level cache together.
constexpr size_t kBlock = 64;

void store(float value, float& to) {
  to = value;
}
void store(float value, Bfloat16& to) {
  to = to_bfloat16(value);
}
float load(float value) {
  return value;
}
float load(Bfloat16 value) {
  return to_float(value);
}

template <typename T>
void read_rows(const float* from, size_t plane, size_t channels, size_t width, T* row) {
  const size_t step = padded_channels(channels);
  std::fill_n(row, width * step, T{});
  for (size_t c = 0; c < channels; ++c) {
    for (size_t x = 0; x < width; ++x) store(from[c * plane + x], row[x * step + c]);
  }
}

template <typename T>
void write_rows(const T* row, size_t channels, size_t width, float* to, size_t plane, std::span<const size_t> planes) {
  const size_t step = padded_channels(channels);
  for (size_t begin = 0; begin < width; begin += kBlock) {
    const size_t end = std::min(width, begin + kBlock);
    for (size_t c = 0; c < channels; ++c) {
      float* const line = to + (planes.empty() ? c : planes[c]) * plane;
      for (size_t x = begin; x < end; ++x) line[x] = load(row[x * step + c]);
    }
  }
}

}  // namespace

void read_planes(const float* from, size_t plane, size_t channels, size_t width, ElementType type, std::byte* row) {
  if (type == ElementType::kFloat32) {
    read_rows(from, plane, channels, width, reinterpret_cast<float*>(row));
  } else {
    read_rows(from, plane, channels, width, reinterpret_cast<Bfloat16*>(row));
  }
}

void write_planes(const std::byte* row, size_t channels, size_t width, ElementType type, float* to, size_t plane,
                  std::span<const size_t> planes) {
  if (type == ElementType::kFloat32) {
    write_rows(reinterpret_cast<const float*>(row), channels, width, to, plane, planes);
  } else {
    write_rows(reinterpret_cast<const Bfloat16*>(row), channels, width, to, plane, planes);
  }
}

}  // namespace e2lf::engine
