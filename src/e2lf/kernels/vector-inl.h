// SPDX-License-Identifier: MIT
// Vector arithmetic shared by the kernels. It is included once per instruction set, after <hwy/highway.h>.
#if defined(E2LF_KERNELS_VECTOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_KERNELS_VECTOR_INL_H_
#undef E2LF_KERNELS_VECTOR_INL_H_
#else
#define E2LF_KERNELS_VECTOR_INL_H_
#endif

#include <cstring>

#include <hwy/highway.h>

#include "e2lf/base/result.h"
#include "e2lf/kernels/elements.h"

// Loops over accumulators must be unrolled so that these stay in registers.
#define E2LF_UNROLL _Pragma("GCC unroll 16")

// bfloat16 kernels are compiled if the instruction set can include AVX512_BF16; whether the CPU has it is tested at run
// time. Better Highway targets have smaller numbers, and later versions have more of them beyond AVX3.
#undef E2LF_TARGET_HAS_BF16
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
#define E2LF_TARGET_HAS_BF16 1
#else
#define E2LF_TARGET_HAS_BF16 0
#endif

// The same for kernels with int16 products, for which AVX-512 needs VNNI.
#undef E2LF_TARGET_HAS_INT16
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
#define E2LF_TARGET_HAS_INT16 1
#else
#define E2LF_TARGET_HAS_INT16 0
#endif

HWY_BEFORE_NAMESPACE();
namespace e2lf::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kChannelMultiple>;
using FloatVec = hn::Vec<FloatTag>;
inline constexpr size_t kLanes = hn::MaxLanes(FloatTag());

// The number of pixels and of output channel vectors whose sums are kept in registers at a time.
inline constexpr size_t kGemmRows = 6;
inline constexpr size_t kGemmVectors = kLanes == 16 ? 4 : 2;

/// The width of the panels of packed weights, which for_column_groups() visits.
inline constexpr size_t kPanelColumns = kGemmVectors * kLanes;

/// Loads kLanes elements as float32, and stores them.
HWY_INLINE FloatVec load_floats(const float* from) {
  return hn::LoadU(FloatTag(), from);
}

HWY_INLINE void store_floats(FloatVec value, float* to) {
  hn::StoreU(value, FloatTag(), to);
}

#if E2LF_TARGET_HAS_BF16
HWY_INLINE FloatVec load_floats(const Bfloat16* from) {
  const hn::Rebind<uint16_t, FloatTag> d16;
  const hn::RebindToUnsigned<FloatTag> d32;
  const auto bits = hn::LoadU(d16, reinterpret_cast<const uint16_t*>(from));
  return hn::BitCast(FloatTag(), hn::ShiftLeft<16>(hn::PromoteTo(d32, bits)));
}

/// Rounds to nearest, with ties to even.
HWY_INLINE void store_floats(FloatVec value, Bfloat16* to) {
  const hn::Rebind<uint16_t, FloatTag> d16;
  hn::Vec<hn::Rebind<uint16_t, FloatTag>> narrow;
  // Highway 1.0 has no function for this instruction.
  asm("vcvtneps2bf16 %1, %0" : "=v"(narrow.raw) : "v"(value.raw));
  hn::StoreU(narrow, d16, reinterpret_cast<uint16_t*>(to));
}
#endif

/// Returns make(Element()) for the element type of a tensor. bfloat16 requires bfloat16_supported().
template <class Make>
auto for_element(ElementType type, const Make& make) {
#if E2LF_TARGET_HAS_BF16
  if (type == ElementType::kBfloat16) return make(Bfloat16());
#endif
  E2LF_REQUIRE(type == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return make(float());
}

/// Defines how the products of one element type are computed: kStep elements of the depth per multiply-add. Tensors
/// have the type Element, and what is multiplied has the type Factor.
struct FloatProducts {
  using Element = float;
  using Factor = float;
  using Sum = FloatVec;
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
  using Factor = Bfloat16;
  using Sum = FloatVec;
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
    // Highway 1.0 has no function for this one, either.
    asm("vdpbf16ps %2, %1, %0" : "+v"(sum.raw) : "v"(a.raw), "v"(b.raw));
    return sum;
  }
};
#endif

#if E2LF_TARGET_HAS_INT16
using IntTag = hn::RebindToSigned<FloatTag>;

struct Int16Products {
  using Element = float;
  using Factor = int16_t;
  using Sum = hn::Vec<IntTag>;
  static constexpr ElementType kType = ElementType::kInt16;
  static constexpr size_t kStep = 2;
  using Tag = hn::Repartition<int16_t, FloatTag>;
  using Vec = hn::Vec<Tag>;

  static HWY_INLINE Vec broadcast(const int16_t* from) {
    int32_t pair;
    std::memcpy(&pair, from, sizeof(pair));
    return hn::BitCast(Tag(), hn::Set(IntTag(), pair));
  }
  static HWY_INLINE Vec load(const int16_t* from) { return hn::Load(Tag(), from); }
  static HWY_INLINE Sum multiply_add(Vec a, Vec b, Sum sum) {
#if HWY_TARGET <= HWY_AVX3
    asm("vpdpwssd %2, %1, %0" : "+v"(sum.raw) : "v"(a.raw), "v"(b.raw));
    return sum;
#else
    auto unused = sum;
    return hn::ReorderWidenMulAccumulate(IntTag(), a, b, sum, unused);
#endif
  }
};
#endif

/// Adds to sums[i][j] the product of row i of `a` (rows are `a_stride` elements apart, and their elements `a_step`) and
/// column vector j of a packed panel whose rows are `width` columns wide, over `depth` elements. If kStep is not 1,
/// a_step is.
template <class Products, size_t kRows, size_t kVectors>
HWY_INLINE void multiply_accumulate(const typename Products::Factor* HWY_RESTRICT a, size_t a_stride,
                                    const typename Products::Factor* HWY_RESTRICT panel, size_t width, size_t depth,
                                    typename Products::Sum (&sums)[kRows][kVectors], size_t a_step = 1) {
  constexpr size_t kStep = Products::kStep;
  for (size_t k = 0; k < depth; k += kStep) {
    typename Products::Vec columns[kVectors];
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) columns[j] = Products::load(panel + j * kLanes * kStep);
    E2LF_UNROLL
    for (size_t i = 0; i < kRows; ++i) {
      const auto row = Products::broadcast(a + i * a_stride + k * a_step);
      E2LF_UNROLL
      for (size_t j = 0; j < kVectors; ++j) sums[i][j] = Products::multiply_add(row, columns[j], sums[i][j]);
    }
    panel += width * kStep;
  }
}

template <size_t kRows, size_t kVectors, class Vec>
HWY_INLINE void clear(Vec (&sums)[kRows][kVectors]) {
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) sums[i][j] = hn::Zero(hn::DFromV<Vec>());
  }
}

/// Calls visit<kVectors>(first column of the panel, offset of the group in the panel, panel width) for groups of column
/// vectors that together cover a packed matrix.
template <class Visitor>
HWY_INLINE void for_column_groups(size_t columns, const Visitor& visitor) {
  for (size_t begin = 0; begin < columns; begin += kPanelColumns) {
    const size_t width = HWY_MIN(kPanelColumns, columns - begin);
    size_t offset = 0;
    for (; offset + kGemmVectors * kLanes <= width; offset += kGemmVectors * kLanes) {
      visitor.template visit<kGemmVectors>(begin, offset, width);
    }
    // A remainder occurs only for 16-lane vectors, because panels are multiples of 16 columns.
    if constexpr (kLanes == 16) {
      const size_t left = (width - offset) / kLanes;
      if (left == 1) visitor.template visit<1>(begin, offset, width);
      if (left == 2) visitor.template visit<2>(begin, offset, width);
      if (left == 3) visitor.template visit<3>(begin, offset, width);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::kernels
HWY_AFTER_NAMESPACE();

#endif
