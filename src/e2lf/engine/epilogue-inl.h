// SPDX-License-Identifier: MIT
// The treatment of finished sums by the kernels. This file is included once per instruction set, after <hwy/highway.h>.
#if defined(E2LF_ENGINE_EPILOGUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_ENGINE_EPILOGUE_INL_H_
#undef E2LF_ENGINE_EPILOGUE_INL_H_
#else
#define E2LF_ENGINE_EPILOGUE_INL_H_
#endif

#include <cstring>
#include <limits>

#include "e2lf/engine/conv.h"
#include "e2lf/engine/row_memory.h"
#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

using namespace kernels::HWY_NAMESPACE;

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
