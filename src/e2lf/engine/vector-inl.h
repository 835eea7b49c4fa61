// SPDX-License-Identifier: MIT
// Included once per instruction set by the kernels, after <hwy/highway.h>: vector arithmetic they share.
#if defined(E2LF_ENGINE_VECTOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_ENGINE_VECTOR_INL_H_
#undef E2LF_ENGINE_VECTOR_INL_H_
#else
#define E2LF_ENGINE_VECTOR_INL_H_
#endif

#include <cstring>

#include <hwy/highway.h>

#include "e2lf/engine/conv.h"
#include "e2lf/engine/pack.h"

// Loops over accumulators must be unrolled for them to live in registers.
#define E2LF_UNROLL _Pragma("GCC unroll 16")

// bfloat16 kernels exist where the instruction set can have AVX512_BF16; whether the CPU does is asked at run time.
#undef E2LF_TARGET_HAS_BF16
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
#define E2LF_TARGET_HAS_BF16 1
#else
#define E2LF_TARGET_HAS_BF16 0
#endif

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kChannelMultiple>;
using FloatVec = hn::Vec<FloatTag>;
inline constexpr size_t kLanes = hn::MaxLanes(FloatTag());

// Pixels x vectors of output channels whose sums are in registers at a time.
inline constexpr size_t kGemmRows = 6;
inline constexpr size_t kGemmVectors = kLanes == 16 ? 4 : 2;

/// kLanes elements as float32.
HWY_INLINE FloatVec load_floats(const float* from) {
  return hn::LoadU(FloatTag(), from);
}

HWY_INLINE FloatVec load_floats(const Bfloat16* from) {
  const hn::Rebind<uint16_t, FloatTag> d16;
  const hn::RebindToUnsigned<FloatTag> d32;
  const auto bits = hn::LoadU(d16, reinterpret_cast<const uint16_t*>(from));
  return hn::BitCast(FloatTag(), hn::ShiftLeft<16>(hn::PromoteTo(d32, bits)));
}

/// kLanes float32 values as elements; bfloat16 rounds to the nearest, ties to even.
HWY_INLINE void store_floats(FloatVec value, float* to) {
  hn::StoreU(value, FloatTag(), to);
}

HWY_INLINE void store_floats(FloatVec value, Bfloat16* to) {
  const hn::Rebind<uint16_t, FloatTag> d16;
  const hn::RebindToUnsigned<FloatTag> d32;
  const auto bits = hn::BitCast(d32, value);
  const auto odd = hn::And(hn::ShiftRight<16>(bits), hn::Set(d32, 1));
  const auto rounded = hn::Add(hn::Add(bits, hn::Set(d32, 0x7FFF)), odd);
  hn::StoreU(hn::TruncateTo(d16, hn::ShiftRight<16>(rounded)), d16, reinterpret_cast<uint16_t*>(to));
}

/// How the products of one element type are made: kStep elements of the depth per multiply-add.
struct FloatProducts {
  using Element = float;
  static constexpr ElementType kType = ElementType::kFloat32;
  static constexpr size_t kStep = 1;
  using Vec = FloatVec;

  static HWY_INLINE Vec broadcast(const float* from) { return hn::Set(FloatTag(), *from); }
  static HWY_INLINE Vec load(const float* from) { return hn::Load(FloatTag(), from); }
  static HWY_INLINE FloatVec multiply_add(Vec a, Vec b, FloatVec sum) { return hn::MulAdd(a, b, sum); }
};

#if E2LF_TARGET_HAS_BF16
struct Bfloat16Products {
  using Element = Bfloat16;
  static constexpr ElementType kType = ElementType::kBfloat16;
  static constexpr size_t kStep = 2;
  using Vec = FloatVec;  ///< holds 32 bfloat16 numbers

  static HWY_INLINE Vec broadcast(const Bfloat16* from) {
    float pair;
    std::memcpy(&pair, from, sizeof(pair));
    return hn::Set(FloatTag(), pair);
  }
  static HWY_INLINE Vec load(const Bfloat16* from) {
    return hn::Load(FloatTag(), reinterpret_cast<const float*>(from));
  }
  static HWY_INLINE FloatVec multiply_add(Vec a, Vec b, FloatVec sum) {
    // Highway 1.0 has no name for this instruction.
    asm("vdpbf16ps %2, %1, %0" : "+v"(sum.raw) : "v"(a.raw), "v"(b.raw));
    return sum;
  }
};
#endif

/// sums[i][j] += the products of row i of `a` (rows `a_stride` elements apart) with column vector j of a packed panel
/// whose rows are `width` columns wide, over `depth` elements.
template <class Products, size_t kRows, size_t kVectors>
HWY_INLINE void multiply_accumulate(const typename Products::Element* HWY_RESTRICT a, size_t a_stride,
                                    const typename Products::Element* HWY_RESTRICT panel, size_t width, size_t depth,
                                    FloatVec (&sums)[kRows][kVectors]) {
  constexpr size_t kStep = Products::kStep;
  for (size_t k = 0; k < depth; k += kStep) {
    typename Products::Vec columns[kVectors];
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) columns[j] = Products::load(panel + j * kLanes * kStep);
    E2LF_UNROLL
    for (size_t i = 0; i < kRows; ++i) {
      const auto row = Products::broadcast(a + i * a_stride + k);
      E2LF_UNROLL
      for (size_t j = 0; j < kVectors; ++j) sums[i][j] = Products::multiply_add(row, columns[j], sums[i][j]);
    }
    panel += width * kStep;
  }
}

template <size_t kRows, size_t kVectors>
HWY_INLINE void clear(FloatVec (&sums)[kRows][kVectors]) {
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) sums[i][j] = hn::Zero(FloatTag());
  }
}

/// Calls visit<kVectors>(column, panel, offset of the column in the panel, panel width) for groups of column vectors
/// that together cover a packed matrix.
template <class Visitor>
HWY_INLINE void for_column_groups(size_t columns, const Visitor& visitor) {
  for (size_t begin = 0; begin < columns; begin += kPanelWidth) {
    const size_t width = HWY_MIN(kPanelWidth, columns - begin);
    size_t offset = 0;
    for (; offset + kGemmVectors * kLanes <= width; offset += kGemmVectors * kLanes) {
      visitor.template visit<kGemmVectors>(begin, offset, width);
    }
    // Only 16-lane vectors have a remainder: panels are multiples of 16 columns.
    if constexpr (kLanes == 16) {
      const size_t left = (width - offset) / kLanes;
      if (left == 1) visitor.template visit<1>(begin, offset, width);
      if (left == 2) visitor.template visit<2>(begin, offset, width);
      if (left == 3) visitor.template visit<3>(begin, offset, width);
    }
  }
}

/// What happens to a finished sum: bias, residual, ReLU, rounding to the output's type.
class Epilogue {
 public:
  Epilogue() = default;
  explicit Epilogue(const ConvSpec& spec)
      : bias_(padded_channels(spec.out_channels) * sizeof(float)),
        relu_(spec.relu),
        residual_(spec.residual),
        residual_type_(spec.compute),
        output_type_(spec.output) {
    std::memcpy(bias_.data(), spec.bias.data(), spec.bias.size() * sizeof(float));
  }

  /// `element` counts from the beginning of the output's and the residual's row; `channel` is its channel.
  HWY_INLINE void store(FloatVec sum, size_t channel, size_t element, const std::byte* residual_row,
                        std::byte* output_row) const {
    FloatVec value = hn::Add(sum, hn::Load(FloatTag(), bias_.as<float>() + channel));
    if (residual_) {
      value = hn::Add(value, residual_type_ == ElementType::kFloat32
                                 ? load_floats(reinterpret_cast<const float*>(residual_row) + element)
                                 : load_floats(reinterpret_cast<const Bfloat16*>(residual_row) + element));
    }
    if (relu_) value = hn::Max(value, hn::Zero(FloatTag()));
    if (output_type_ == ElementType::kFloat32) {
      store_floats(value, reinterpret_cast<float*>(output_row) + element);
    } else {
      store_floats(value, reinterpret_cast<Bfloat16*>(output_row) + element);
    }
  }

  [[nodiscard]] const std::byte* residual_row(const Strip& strip, size_t y) const {
    return residual_ ? strip.residual.row<const std::byte>(static_cast<ptrdiff_t>(y)) : nullptr;
  }

 private:
  AlignedBuffer bias_;
  bool relu_ = false;
  bool residual_ = false;
  ElementType residual_type_ = ElementType::kFloat32;
  ElementType output_type_ = ElementType::kFloat32;
};

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#endif
