// SPDX-License-Identifier: MIT
// Bilinear upsampling; see Op::kUpsampleBilinear.
#include <algorithm>
#include <limits>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"
#include "e2lf/model/onnx/onnx_export.h"
#include "e2lf/video/operations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/bilinear.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::video {
namespace HWY_NAMESPACE {
namespace {

using namespace kernels::HWY_NAMESPACE;
using namespace engine;

/// The two inputs of an output along an axis, and the weight of the second one.
struct Between {
  size_t first, second;
  float share;
};

/// Output pixel i lies at (i + 1/2) / stride - 1/2. Positions beyond the edge take the value at the edge.
HWY_INLINE Between between(size_t i, size_t stride, size_t size) {
  const float at = (static_cast<float>(i) + 0.5F) / static_cast<float>(stride) - 0.5F;
  if (at <= 0.0F) return {0, 0, 0.0F};
  const auto first = static_cast<size_t>(at);
  return {first, HWY_MIN(first + 1, size - 1), at - static_cast<float>(first)};
}

template <class Element>
class BilinearKernel final : public Kernel {
 public:
  BilinearKernel(size_t channels, size_t stride, bool relu)
      : step_(padded_channels(channels)),
        stride_(stride),
        floor_(relu ? 0.0F : -std::numeric_limits<float>::infinity()) {}

  std::string describe() const override { return std::string("bilinear ") + hwy::TargetName(HWY_TARGET); }
  Reach reach() const override { return {1, 1, 1, stride_}; }
  size_t num_blocks(const Strip& strip) const override { return strip.end - strip.begin; }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const FloatTag d;
    const size_t y = strip.begin + block;
    const Between row = between(y, stride_, strip.height / stride_);
    const auto* above = strip.inputs[0].row<const Element>(static_cast<ptrdiff_t>(row.first));
    const auto* below = strip.inputs[0].row<const Element>(static_cast<ptrdiff_t>(row.second));
    auto* output = strip.output.row<Element>(static_cast<ptrdiff_t>(y));
    const auto down = hn::Set(d, row.share), floor = hn::Set(d, floor_);
    for (size_t x = 0; x < strip.width; ++x) {
      const Between column = between(x, stride_, strip.width / stride_);
      const auto right = hn::Set(d, column.share);
      const size_t first = column.first * step_, second = column.second * step_;
      for (size_t c = 0; c < step_; c += kLanes) {
        const auto top = blend(load_floats(above + first + c), load_floats(above + second + c), right);
        const auto bottom = blend(load_floats(below + first + c), load_floats(below + second + c), right);
        store_floats(hn::Max(blend(top, bottom, down), floor), output + x * step_ + c);
      }
    }
  }

 private:
  static HWY_INLINE FloatVec blend(FloatVec a, FloatVec b, FloatVec share) {
    return hn::MulAdd(share, hn::Sub(b, a), a);
  }

  size_t step_, stride_;
  float floor_;  ///< zero for ReLU, otherwise below any value
};

}  // namespace

std::unique_ptr<Kernel> MakeBilinear(size_t channels, size_t stride, bool relu, ElementType type) {
  return for_element(type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<BilinearKernel<decltype(element)>>(channels, stride, relu);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

using engine::PlanBuilder;
using model::Layer, model::LayerShape;

HWY_EXPORT(MakeBilinear);

namespace {

Result<void> plan_bilinear(PlanBuilder& build, const Layer& layer) {
  const engine::TensorSpec& spec = build.spec(layer.name);
  build.add(layer, HWY_DYNAMIC_DISPATCH(MakeBilinear)(spec.channels, layer.stride, layer.relu, spec.type));
  return {};
}

}  // namespace

engine::Operation bilinear_upsampling() {
  return {.model = {.name = Op::kUpsampleBilinear,
                    .takes_stride_and_relu = true,
                    .shape =
                        [](const Layer& layer, std::span<const LayerShape> inputs) {
                          return model::finer_shape(layer, inputs, inputs[0].channels);
                        },
                    .reach = [](const Layer&) { return size_t{1}; },
                    .onnx =
                        [](model::OnnxCall& call) {
                          return call.resize({{"mode", std::string("linear")},
                                              {"coordinate_transformation_mode", std::string("half_pixel")}});
                        }},
          .plan = plan_bilinear};
}

}  // namespace e2lf::video
#endif
