// SPDX-License-Identifier: MIT
#include "e2lf/video/cells.h"

#include "e2lf/base/contract.h"
#include "e2lf/engine/pack.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/pixel_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::video {
namespace HWY_NAMESPACE {
namespace {

using namespace engine::HWY_NAMESPACE;
using namespace engine;

// The functions that kernels apply to kLanes channels of a pixel. The arguments are the elements of their inputs from
// the first of these channels on; `part` is the number of channels from one gate to the next.

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

std::unique_ptr<Kernel> MakeTanh(size_t channels, ElementType type) {
  return one_to_one<TanhOf>("tanh", channels, type);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

using engine::ElementType, engine::Kernel;

HWY_EXPORT(MakeJoin);
HWY_EXPORT(MakeReset);
HWY_EXPORT(MakeBlend);
HWY_EXPORT(MakeLstmMemory);
HWY_EXPORT(MakeLstmOutput);
HWY_EXPORT(MakeCellOutput);
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

std::unique_ptr<Kernel> make_tanh(size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeTanh)(channels, type);
}

}  // namespace e2lf::video
#endif
