// SPDX-License-Identifier: MIT
// What the kernels of convolutions share: the positions of taps, the factors that they multiply, and the treatment of
// finished sums. This file is included once per instruction set, after <hwy/highway.h>.
#if defined(E2LF_ENGINE_CONV_KERNEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_ENGINE_CONV_KERNEL_INL_H_
#undef E2LF_ENGINE_CONV_KERNEL_INL_H_
#else
#define E2LF_ENGINE_CONV_KERNEL_INL_H_
#endif

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/row_memory.h"
#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

using namespace kernels::HWY_NAMESPACE;

/// The positions of the taps of a convolution that sums them one by one. In a transposed convolution, each output pixel
/// has exactly one tap, which is determined by its position within the stride (the phase).
struct TapGrid {
  explicit TapGrid(const ConvSpec& spec)
      : kernel(spec.kernel),
        stride(spec.stride),
        transposed(spec.transposed),
        radius(spec.stride == spec.kernel ? 0 : spec.kernel / 2),
        in_stride(padded_channels(spec.in_channels)) {}

  [[nodiscard]] Reach reach() const {
    if (transposed) return {0, 0, 1, stride};
    // `down` already counts the pixels that the kernel's centre covers in the last step of a stride.
    return {radius, radius > stride - 1 ? radius - (stride - 1) : 0, stride, 1};
  }

  /// Returns the number of sums along a row, without phases: inputs of a transposed convolution, and outputs otherwise.
  [[nodiscard]] size_t sums_per_row(const Strip& strip) const {
    return transposed ? strip.width / stride : strip.width;
  }
  [[nodiscard]] size_t phases() const { return transposed ? stride : 1; }

  /// Returns the number of blocks of this many sums that make up a row.
  [[nodiscard]] size_t blocks_per_row(const Strip& strip, size_t sums) const {
    return (sums_per_row(strip) + sums - 1) / sums;
  }

  /// Returns the distance in elements from the input of one sum to that of the next.
  [[nodiscard]] size_t pixel_step() const { return (transposed ? 1 : stride) * in_stride; }

  /// Returns the input of sum `x` in output row `y` under tap (dy, dx), or under its one tap if the convolution is
  /// transposed.
  template <typename T>
  [[nodiscard]] const T* input(const Strip& strip, size_t y, size_t x, size_t dy = 0, size_t dx = 0) const {
    if (transposed) return strip.inputs[0].row<const T>(static_cast<ptrdiff_t>(y / stride)) + x * in_stride;
    const auto in_y = static_cast<ptrdiff_t>(y * stride + dy) - static_cast<ptrdiff_t>(radius);
    const auto in_x = static_cast<ptrdiff_t>(x * stride + dx) - static_cast<ptrdiff_t>(radius);
    return strip.inputs[0].row<const T>(in_y) + in_x * static_cast<ptrdiff_t>(in_stride);
  }

  size_t kernel, stride;
  bool transposed;
  size_t radius;
  size_t in_stride;  ///< elements of an input pixel
};

/// The weights of a kernel. Its inputs and sums are floating-point numbers, and `scale` and `unit` have no effect.
template <class Products>
struct Factors {
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
std::unique_ptr<Kernel> make_conv_kernel(const ConvSpec& spec, bool integers) {
  E2LF_REQUIRE(!integers || int16_supported(), "int16 products are not faster than float32 on this CPU");
  E2LF_REQUIRE(!integers || spec.compute == ElementType::kFloat32, "integers are made from float32");
#if E2LF_TARGET_HAS_INT16
  if (integers) return std::make_unique<KernelOf<Int16Products>>(spec);
#endif
#if E2LF_TARGET_HAS_BF16
  if (spec.compute == ElementType::kBfloat16) return std::make_unique<KernelOf<Bfloat16Products>>(spec);
#endif
  E2LF_REQUIRE(spec.compute == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return std::make_unique<KernelOf<FloatProducts>>(spec);
}

/// Applies bias, residual and ReLU to finished sums and rounds them to the type of the output.
template <class Products>
class Epilogue {
  using Element = typename Products::Element;

 public:
  explicit Epilogue(const ConvSpec& spec)
      : bias_(padded_channels(spec.out_channels) * sizeof(float)),
        floor_(spec.relu ? 0.0F : -std::numeric_limits<float>::infinity()),
        residual_(spec.residual),
        wide_(spec.output == ElementType::kFloat32) {
    std::memcpy(bias_.data(), spec.bias.data(), spec.bias.size() * sizeof(float));
  }

  /// The beginnings of output row y and of the same row of the residual.
  struct Row {
    const Element* residual;
    std::byte* output;
  };

  [[nodiscard]] Row row(const Strip& strip, size_t y) const {
    const auto index = static_cast<ptrdiff_t>(y);
    return {residual_ ? strip.residual.row<const Element>(index) : nullptr, strip.output.row<std::byte>(index)};
  }

  /// Calls visitor.visit<whether there is a residual, the element type of the output>().
  template <class Visitor>
  HWY_INLINE void select(const Visitor& visitor) const {
    if (residual_ && wide_) visitor.template visit<true, float>();
    if (residual_ && !wide_) visitor.template visit<true, Element>();
    if (!residual_ && wide_) visitor.template visit<false, float>();
    if (!residual_ && !wide_) visitor.template visit<false, Element>();
  }

  /// The constants that store() needs for kLanes channels. They stay in registers while many pixels are stored.
  struct Channels {
    FloatVec bias, floor;
  };

  HWY_INLINE Channels channels(size_t first) const {
    return {hn::Load(FloatTag(), bias_.as<float>() + first), hn::Set(FloatTag(), floor_)};
  }

  /// Stores a vector of sums; `element` counts from the beginning of the row.
  template <bool kResidual, class Output>
  static HWY_INLINE void store(FloatVec sum, const Channels& channels, size_t element, const Row& row) {
    FloatVec value = hn::Add(sum, channels.bias);
    if constexpr (kResidual) value = hn::Add(value, load_floats(row.residual + element));
    store_floats(hn::Max(value, channels.floor), reinterpret_cast<Output*>(row.output) + element);
  }

 private:
  AlignedBuffer bias_;
  float floor_;  ///< zero for ReLU, otherwise below any value
  bool residual_;
  bool wide_;  ///< the output is float32
};

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#endif
