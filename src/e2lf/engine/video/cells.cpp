// SPDX-License-Identifier: MIT
#include "e2lf/engine/video/cells.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "e2lf/base/contract.h"
#include "e2lf/engine/pack.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/video/cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// clang-format off: it must come behind foreach_target.h
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {
namespace {

using namespace kernels::HWY_NAMESPACE;

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

// The functions that kernels apply to kLanes channels of a pixel. The arguments are the elements of their inputs from
// the first of these channels on; `part` is the number of channels from one gate to the next.

struct SigmoidOf {
  template <class Element>
  HWY_INLINE FloatVec operator()(const Element* x) const {
    return sigmoid(load_floats(x));
  }
};

struct TanhOf {
  template <class Element>
  HWY_INLINE FloatVec operator()(const Element* x) const {
    return tanh(load_floats(x));
  }
};

struct Copy {
  template <class Element>
  HWY_INLINE FloatVec operator()(const Element* x) const {
    return load_floats(x);
  }
};

struct Reset {
  size_t part;
  HWY_INLINE FloatVec operator()(const float* state, const float* gates) const {
    return hn::Mul(sigmoid(load_floats(gates + part)), load_floats(state));
  }
};

struct Blend {
  HWY_INLINE FloatVec operator()(const float* candidate, const float* state, const float* gates) const {
    const auto before = load_floats(state);
    return hn::MulAdd(sigmoid(load_floats(gates)), hn::Sub(tanh(load_floats(candidate)), before), before);
  }
};

struct LstmMemory {
  size_t part;
  HWY_INLINE FloatVec operator()(const float* gates, const float* state) const {
    const auto added = hn::Mul(sigmoid(load_floats(gates)), tanh(load_floats(gates + 3 * part)));
    return hn::MulAdd(sigmoid(load_floats(gates + part)), load_floats(state), added);
  }
};

struct LstmOutput {
  size_t part;
  HWY_INLINE FloatVec operator()(const float* gates, const float* memory) const {
    return hn::Mul(sigmoid(load_floats(gates + 2 * part)), tanh(load_floats(memory)));
  }
};

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
  Reach reach() const override { return {}; }
  size_t num_blocks(const Strip& strip) const override { return strip.end - strip.begin; }

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

}  // namespace

template <class Element>
std::unique_ptr<Kernel> JoinOf(size_t in_channels, size_t channels) {
  return make_kernel<Element>("join", channels, in_channels, Copy{}, Source<float>{1, padded_channels(channels)});
}

template <class Element>
std::unique_ptr<Kernel> ResetOf(size_t in_channels, size_t channels) {
  return make_kernel<Element>("GRU reset", channels, in_channels, Reset{channels},
                              Source<float>{1, padded_channels(channels)},
                              Source<float>{2, padded_channels(2 * channels)});
}

std::unique_ptr<Kernel> MakeJoin(size_t in_channels, size_t channels, ElementType type) {
#if E2LF_TARGET_HAS_BF16
  if (type == ElementType::kBfloat16) return JoinOf<Bfloat16>(in_channels, channels);
#endif
  E2LF_REQUIRE(type == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return JoinOf<float>(in_channels, channels);
}

std::unique_ptr<Kernel> MakeReset(size_t in_channels, size_t channels, ElementType type) {
#if E2LF_TARGET_HAS_BF16
  if (type == ElementType::kBfloat16) return ResetOf<Bfloat16>(in_channels, channels);
#endif
  E2LF_REQUIRE(type == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return ResetOf<float>(in_channels, channels);
}

std::unique_ptr<Kernel> MakeBlend(size_t channels) {
  const size_t step = padded_channels(channels);
  return make_kernel<float>("GRU blend", channels, 0, Blend{}, Source<float>{0, step}, Source<float>{1, step},
                            Source<float>{2, padded_channels(2 * channels)});
}

std::unique_ptr<Kernel> MakeLstmMemory(size_t channels) {
  return make_kernel<float>("LSTM memory", channels, 0, LstmMemory{channels},
                            Source<float>{0, padded_channels(4 * channels)},
                            Source<float>{1, padded_channels(channels)});
}

std::unique_ptr<Kernel> MakeLstmOutput(size_t channels) {
  return make_kernel<float>("LSTM output", channels, 0, LstmOutput{channels},
                            Source<float>{0, padded_channels(4 * channels)},
                            Source<float>{1, padded_channels(channels)});
}

std::unique_ptr<Kernel> MakeCellOutput(size_t channels, ElementType type) {
  const Source<float> source{0, padded_channels(channels)};
#if E2LF_TARGET_HAS_BF16
  if (type == ElementType::kBfloat16) return make_kernel<Bfloat16>("round", channels, 0, Copy{}, source);
#endif
  E2LF_REQUIRE(type == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return make_kernel<float>("copy", channels, 0, Copy{}, source);
}

template <class Function>
std::unique_ptr<Kernel> OneToOne(const char* name, size_t channels, ElementType type) {
#if E2LF_TARGET_HAS_BF16
  if (type == ElementType::kBfloat16) {
    return make_kernel<Bfloat16>(name, channels, 0, Function{}, Source<Bfloat16>{0, padded_channels(channels)});
  }
#endif
  E2LF_REQUIRE(type == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return make_kernel<float>(name, channels, 0, Function{}, Source<float>{0, padded_channels(channels)});
}

std::unique_ptr<Kernel> MakeSigmoid(size_t channels, ElementType type) {
  return OneToOne<SigmoidOf>("sigmoid", channels, type);
}

std::unique_ptr<Kernel> MakeTanh(size_t channels, ElementType type) {
  return OneToOne<TanhOf>("tanh", channels, type);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::engine {
namespace {

class RecallKernel final : public Kernel {
 public:
  std::string describe() const override { return "of the frame before"; }
  Reach reach() const override { return {}; }
  size_t num_blocks(const Strip& /*strip*/) const override { return 0; }
  void run_block(const Strip& /*strip*/, size_t /*block*/, std::byte* /*scratch*/) const override {}
};

}  // namespace

HWY_EXPORT(MakeJoin);
HWY_EXPORT(MakeReset);
HWY_EXPORT(MakeBlend);
HWY_EXPORT(MakeLstmMemory);
HWY_EXPORT(MakeLstmOutput);
HWY_EXPORT(MakeCellOutput);
HWY_EXPORT(MakeSigmoid);
HWY_EXPORT(MakeTanh);

std::unique_ptr<Kernel> make_cell_join(size_t in_channels, size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeJoin)(in_channels, channels, type);
}

std::unique_ptr<Kernel> make_gru_reset(size_t in_channels, size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeReset)(in_channels, channels, type);
}

std::unique_ptr<Kernel> make_gru_blend(size_t channels) {
  return HWY_DYNAMIC_DISPATCH(MakeBlend)(channels);
}

std::unique_ptr<Kernel> make_lstm_memory(size_t channels) {
  return HWY_DYNAMIC_DISPATCH(MakeLstmMemory)(channels);
}

std::unique_ptr<Kernel> make_lstm_output(size_t channels) {
  return HWY_DYNAMIC_DISPATCH(MakeLstmOutput)(channels);
}

std::unique_ptr<Kernel> make_cell_output(size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeCellOutput)(channels, type);
}

std::unique_ptr<Kernel> make_sigmoid(size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeSigmoid)(channels, type);
}

std::unique_ptr<Kernel> make_tanh(size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeTanh)(channels, type);
}

std::unique_ptr<Kernel> make_recall() {
  return std::make_unique<RecallKernel>();
}

}  // namespace e2lf::engine
#endif
