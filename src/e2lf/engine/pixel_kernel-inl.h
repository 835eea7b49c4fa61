// SPDX-License-Identifier: MIT
// Kernels that compute each pixel from the pixels at its place. It is included once per instruction set, after
// <hwy/highway.h>.
#if defined(E2LF_ENGINE_PIXEL_KERNEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_ENGINE_PIXEL_KERNEL_INL_H_
#undef E2LF_ENGINE_PIXEL_KERNEL_INL_H_
#else
#define E2LF_ENGINE_PIXEL_KERNEL_INL_H_
#endif

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>

// clang-format off: it must come behind foreach_target.h
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include "e2lf/base/result.h"
#include "e2lf/engine/kernel.h"
#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

using namespace kernels::HWY_NAMESPACE;
using kernels::Bfloat16;

/// 1 / (1 + exp(-x)).
HWY_INLINE FloatVec sigmoid(FloatVec x) {
  const FloatTag d;
  // Beyond this, exp() overflows. The result is then 0 in float32 anyway.
  constexpr float kLargest = 88.0F;
  const auto e = hn::Exp(d, hn::Min(hn::Neg(x), hn::Set(d, kLargest)));
  return hn::Div(hn::Set(d, 1.0F), hn::Add(hn::Set(d, 1.0F), e));
}

/// Returns tanh(x) = 2 sigmoid(2 x) - 1, within 2e-7.
HWY_INLINE FloatVec tanh(FloatVec x) {
  const FloatTag d;
  return hn::MulSub(hn::Set(d, 2.0F), sigmoid(hn::Add(x, x)), hn::Set(d, 1.0F));
}

/// Input `index` of a kernel: rows of pixels with `step` elements of this type.
template <class Element>
struct Source {
  using Type = Element;
  size_t index;
  size_t step;

  HWY_INLINE const Element* pixel(const Strip& strip, size_t y, size_t x) const {
    return strip.inputs[index].template row<const Element>(static_cast<ptrdiff_t>(y)) + x * step;
  }
};

/// Writes `channels` results of `function` to each output pixel, from element `offset` on. They are preceded by as many
/// channels of input 0.
template <class Output, class Function, class... Elements>
class PixelKernel final : public Kernel {
 public:
  PixelKernel(std::string name, size_t channels, size_t offset, Function function, Source<Elements>... sources)
      : name_(std::move(name)),
        channels_(channels),
        offset_(offset),
        step_(padded_channels(offset + channels)),
        function_(function),
        sources_(sources...) {}

  std::string describe() const override { return name_ + " " + hwy::TargetName(HWY_TARGET); }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const size_t y = strip.begin + block;
    auto* output = strip.output.row<Output>(static_cast<ptrdiff_t>(y));
    for (size_t x = 0; x < strip.width; ++x) {
      Output* pixel = output + x * step_;
      if (offset_ > 0) copy_first(strip, y, x, pixel);
      std::apply([&](const auto&... source) { fill(pixel + offset_, source.pixel(strip, y, x)...); }, sources_);
    }
  }

 private:
  /// Copies the channels of input 0, whose padding is zero, and clears the rest of the pixel.
  void copy_first(const Strip& strip, size_t y, size_t x, Output* pixel) const {
    const size_t size = padded_channels(offset_);
    const auto* from = strip.inputs[0].row<const Output>(static_cast<ptrdiff_t>(y)) + x * size;
    std::copy_n(from, size, pixel);
    std::fill(pixel + size, pixel + step_, Output{});
  }

  /// Writes zeros to lanes beyond the channels. They may belong to the next pixel, which is written later, or to the
  /// zeros after the last one.
  template <class... Pointers>
  HWY_INLINE void fill(Output* to, const Pointers*... from) const {
    const FloatTag d;
    for (size_t c = 0; c < channels_; c += kLanes) {
      const auto value = function_((from + c)...);
      store_floats(hn::IfThenElseZero(hn::FirstN(d, channels_ - c), value), to + c);
    }
    // Vectors may be shorter than the padding.
    for (size_t c = round_up(channels_, kLanes); offset_ + c < step_; ++c) to[c] = Output{};
  }

  std::string name_;
  size_t channels_, offset_, step_;
  Function function_;
  std::tuple<Source<Elements>...> sources_;
};

template <class Output, class Function, class... Elements>
std::unique_ptr<Kernel> make_kernel(const char* name, size_t channels, size_t offset, Function function,
                                    Source<Elements>... sources) {
  return std::make_unique<PixelKernel<Output, Function, Elements...>>(name, channels, offset, function, sources...);
}

/// Makes the kernel that applies a function to one input, which has the type of the output.
template <class Function>
std::unique_ptr<Kernel> one_to_one(const char* name, size_t channels, ElementType type) {
  const size_t step = padded_channels(channels);
  return for_element(type, [&](auto element) {
    using Element = decltype(element);
    return make_kernel<Element>(name, channels, 0, Function{}, Source<Element>{0, step});
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#endif
