// SPDX-License-Identifier: MIT
// The weights of convolutions, and the values with which they are multiplied. This file is included once per
// instruction set, after <hwy/highway.h>.
#if defined(E2LF_ENGINE_FACTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_ENGINE_FACTORS_INL_H_
#undef E2LF_ENGINE_FACTORS_INL_H_
#else
#define E2LF_ENGINE_FACTORS_INL_H_
#endif

#include "e2lf/engine/conv.h"
#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

using namespace kernels::HWY_NAMESPACE;

/// The weights of a kernel. Its inputs and sums are floating-point numbers, and `scale` and `unit` have no effect.
template <class Products>
struct Factors {
  using Packed = PackedMatrices;
  static constexpr bool kAreIntegers = false;

  explicit Factors(PackedMatrices packed, size_t /*columns*/) : weights(std::move(packed)) {}

  static HWY_INLINE void store(FloatVec value, FloatVec /*scale*/, typename Products::Factor* to) {
    store_floats(value, to);
  }
  HWY_INLINE FloatVec unit(size_t /*channel*/, float /*input_unit*/) const { return hn::Zero(FloatTag()); }
  static HWY_INLINE FloatVec value(FloatVec sum) { return sum; }
  static HWY_INLINE FloatVec scaled(FloatVec sum, FloatVec /*unit*/) { return sum; }

  PackedMatrices weights;
};

#if E2LF_TARGET_HAS_INT16
/// Weights as integers. Inputs are multiplied by `scale` and rounded; one in a sum is worth `unit`.
template <>
struct Factors<Int16Products> {
  using Packed = ScaledWeights;
  static constexpr bool kAreIntegers = true;
  static constexpr float kLeast = 1e-30F;

  Factors(ScaledWeights packed, size_t columns)
      : weights(std::move(packed.weights)), units(padded_channels(columns) * sizeof(float)) {
    std::copy(packed.units.begin(), packed.units.end(), units.as<float>());
  }

  /// Returns the largest magnitude of kLanes-fold many values, and at least kLeast, so that scales are finite.
  static HWY_INLINE float largest_of(const float* from, size_t count) {
    const IntTag d;
    const auto magnitude = hn::Set(d, INT32_MAX);
    // Floats that are not negative have the order of integers.
    Int16Products::Sum most = hn::BitCast(d, hn::Set(FloatTag(), kLeast)), other = most;
    size_t i = 0;
    const auto bits = [&](size_t at) HWY_ATTR { return hn::And(hn::BitCast(d, load_floats(from + at)), magnitude); };
    for (; i + 2 * kLanes <= count; i += 2 * kLanes) {
      most = hn::Max(most, bits(i));
      other = hn::Max(other, bits(i + kLanes));
    }
    if (i < count) most = hn::Max(most, bits(i));
    return hn::GetLane(hn::MaxOfLanes(FloatTag(), hn::BitCast(FloatTag(), hn::Max(most, other))));
  }

  static HWY_INLINE void store(FloatVec value, FloatVec scale, int16_t* to) {
    const hn::Rebind<int16_t, FloatTag> narrow;
    hn::StoreU(hn::DemoteTo(narrow, nearest(hn::Mul(value, scale))), narrow, to);
  }
  HWY_INLINE FloatVec unit(size_t channel, float input_unit) const {
    return hn::Mul(hn::Load(FloatTag(), units.as<float>() + channel), hn::Set(FloatTag(), input_unit));
  }
  static HWY_INLINE FloatVec value(Int16Products::Sum sum) { return hn::ConvertTo(FloatTag(), sum); }
  static HWY_INLINE FloatVec scaled(FloatVec sum, FloatVec unit) { return hn::Mul(sum, unit); }

  /// hn::NearestInt() without its treatment of numbers beyond the range.
  static HWY_INLINE Int16Products::Sum nearest(FloatVec value) {
#if HWY_TARGET <= HWY_AVX3
    return Int16Products::Sum{_mm512_cvtps_epi32(value.raw)};
#else
    return Int16Products::Sum{_mm256_cvtps_epi32(value.raw)};
#endif
  }

  PackedMatrices weights;
  AlignedBuffer units;
};
#endif

/// Returns the instruction set of a kernel and the type in which it multiplies, "AVX2 float32".
template <class Products>
std::string describe_products() {
  return std::string(hwy::TargetName(HWY_TARGET)) + (Factors<Products>::kAreIntegers ? " int16"
                                                     : Products::kStep == 2          ? " bfloat16"
                                                                                     : " float32");
}

/// Makes a kernel that multiplies in the type in which the convolution computes, or in integers.
template <template <class> class KernelOf>
std::unique_ptr<Kernel> make_of_floats(const ConvSpec& spec) {
#if E2LF_TARGET_HAS_BF16
  if (spec.compute == ElementType::kBfloat16) return std::make_unique<KernelOf<Bfloat16Products>>(spec);
#endif
  E2LF_REQUIRE(spec.compute == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return std::make_unique<KernelOf<FloatProducts>>(spec);
}

template <template <class> class KernelOf>
std::unique_ptr<Kernel> make_of_integers([[maybe_unused]] const ConvSpec& spec) {
#if E2LF_TARGET_HAS_INT16
  E2LF_REQUIRE(spec.compute == ElementType::kFloat32, "integers are made from float32");
  return std::make_unique<KernelOf<Int16Products>>(spec);
#else
  E2LF_REQUIRE(false, "integers need int16_supported()");
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#endif
