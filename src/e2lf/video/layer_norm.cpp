// SPDX-License-Identifier: MIT
// Layer normalisation; see Op::kLayerNorm.
#include <cmath>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"
#include "e2lf/video/operations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/layer_norm.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::video {
namespace HWY_NAMESPACE {
namespace {

using namespace kernels::HWY_NAMESPACE;
using namespace engine;

/// Normalises each pixel. One block is one row.
template <class Element>
class LayerNormKernel final : public Kernel {
 public:
  LayerNormKernel(std::vector<float> weight, std::vector<float> bias)
      : channels_(weight.size()),
        step_(padded_channels(weight.size())),
        weight_(std::move(weight)),
        bias_(std::move(bias)) {
    // These zeros make the padding of the output zero.
    weight_.resize(step_);
    bias_.resize(step_);
  }

  std::string describe() const override { return std::string("layer norm ") + hwy::TargetName(HWY_TARGET); }
  Reach reach() const override { return {}; }
  size_t num_blocks(const Strip& strip) const override { return strip.end - strip.begin; }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const auto y = static_cast<ptrdiff_t>(strip.begin + block);
    const auto* from = strip.inputs[0].row<const Element>(y);
    auto* to = strip.output.row<Element>(y);
    for (size_t x = 0; x < strip.width; ++x, from += step_, to += step_) normalise(from, to);
  }

 private:
  HWY_INLINE void normalise(const Element* from, Element* to) const {
    constexpr float kEps = 1e-5F;
    const FloatTag d;
    const auto share = 1.0F / static_cast<float>(channels_);
    auto sum = hn::Zero(d);
    for (size_t c = 0; c < step_; c += kLanes) sum = hn::Add(sum, load_floats(from + c));
    const auto mean = hn::Mul(hn::SumOfLanes(d, sum), hn::Set(d, share));
    auto squares = hn::Zero(d);
    for (size_t c = 0; c < channels_; c += kLanes) {
      const auto apart = hn::IfThenElseZero(hn::FirstN(d, channels_ - c), hn::Sub(load_floats(from + c), mean));
      squares = hn::MulAdd(apart, apart, squares);
    }
    const float variance = hn::GetLane(hn::SumOfLanes(d, squares)) * share;
    const auto scale = hn::Set(d, 1.0F / std::sqrt(variance + kEps));
    for (size_t c = 0; c < step_; c += kLanes) {
      const auto value = hn::Mul(hn::Sub(load_floats(from + c), mean), scale);
      store_floats(hn::MulAdd(value, load_floats(&weight_[c]), load_floats(&bias_[c])), to + c);
    }
  }

  size_t channels_, step_;
  std::vector<float> weight_, bias_;
};

}  // namespace

std::unique_ptr<Kernel> MakeLayerNorm(const std::vector<float>& weight, const std::vector<float>& bias,
                                      ElementType type) {
  return for_element(type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<LayerNormKernel<decltype(element)>>(weight, bias);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

using engine::PlanBuilder;
using model::Layer, model::LayerShape;

HWY_EXPORT(MakeLayerNorm);

namespace {

Result<void> plan_layer_norm(PlanBuilder& build, const Layer& layer) {
  const engine::TensorSpec& spec = build.spec(layer.name);
  E2LF_ASSIGN_OR_RETURN(const auto weight, build.weights(layer.name + ".weight", spec.channels));
  E2LF_ASSIGN_OR_RETURN(const auto bias, build.weights(layer.name + ".bias", spec.channels));
  build.add(layer, HWY_DYNAMIC_DISPATCH(MakeLayerNorm)(weight, bias, spec.type));
  return {};
}

}  // namespace

engine::Operation layer_norm() {
  return {
      .model =
          {.name = Op::kLayerNorm,
           .shape = model::equal_shapes,
           .weights =
               [](const Layer& layer, std::span<const LayerShape> inputs) {
                 const std::vector<size_t> shape = {inputs[0].channels};
                 return std::vector<model::WeightShape>{{layer.name + ".weight", shape}, {layer.name + ".bias", shape}};
               }},
      .plan = plan_layer_norm};
}

}  // namespace e2lf::video
#endif
