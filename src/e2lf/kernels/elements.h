// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace e2lf::kernels {

/// The storage type of elements. Tensors are float32 or bfloat16, with sums in float32; int16 is the type of
/// transformed values and weights alone, with sums in int32.
enum class ElementType { kFloat32, kBfloat16, kInt16 };

[[nodiscard]] constexpr size_t element_size(ElementType type) {
  return type == ElementType::kFloat32 ? 4 : 2;
}

/// A bfloat16 number, which is the upper half of a float32.
struct Bfloat16 {
  uint16_t bits = 0;
};

/// Rounds to the nearest bfloat16, with ties to even. The value must be finite.
[[nodiscard]] inline Bfloat16 to_bfloat16(float value) {
  uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  return {static_cast<uint16_t>((bits + 0x7FFFU + ((bits >> 16U) & 1U)) >> 16U)};
}

[[nodiscard]] inline float to_float(Bfloat16 value) {
  const uint32_t bits = static_cast<uint32_t>(value.bits) << 16U;
  float result = 0.0F;
  std::memcpy(&result, &bits, sizeof(result));
  return result;
}

[[nodiscard]] inline float to_float(float value) {
  return value;
}

inline void assign(float value, float& to) {
  to = value;
}
inline void assign(float value, Bfloat16& to) {
  to = to_bfloat16(value);
}

/// Returns visit(Element()) for the element type of a tensor.
template <class Visit>
auto with_element(ElementType type, const Visit& visit) {
  return type == ElementType::kFloat32 ? visit(float()) : visit(Bfloat16());
}

/// Pixels are stored with their channels padded to this multiple. The padding holds zeros.
inline constexpr size_t kChannelMultiple = 16;

/// The columns of a matrix are packed in panels of at most this width.
inline constexpr size_t kPanelWidth = 64;

[[nodiscard]] constexpr size_t round_up(size_t value, size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

[[nodiscard]] constexpr size_t padded_channels(size_t channels) {
  return round_up(channels, kChannelMultiple);
}

// Winograd's F(4, 3) with the points 0, +-a, +-b and infinity (Lavin and Gray, "Fast algorithms for convolutional
// neural networks", CVPR 2016): y = A^T [(G g) * (B^T x)] for six samples x, three taps g and four outputs y. In two
// dimensions, the transforms are applied to columns and then to rows.
inline constexpr double kWinogradA = 1.0;
inline constexpr double kWinogradB = 2.0;
inline constexpr size_t kWinogradPoints = 6;
inline constexpr size_t kWinogradMatrices = kWinogradPoints * kWinogradPoints;

/// Tiles have 4x4 outputs and are aligned to the corner of the image.
inline constexpr size_t kTileSize = 4;

}  // namespace e2lf::kernels
