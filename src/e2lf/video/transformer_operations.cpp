// SPDX-License-Identifier: MIT
// What transformers do with each pixel beside attention; see VideoOp::kLayerNorm and VideoOp::kPositionCode.
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"
#include "e2lf/video/operations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/transformer_operations.cpp"
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

Result<void> PlanLayerNorm(PlanBuilder& build, const model::Layer& layer) {
  const TensorSpec& spec = build.spec(layer.name);
  E2LF_ASSIGN_OR_RETURN(const auto weight, build.weights(layer.name + ".weight", spec.channels));
  E2LF_ASSIGN_OR_RETURN(const auto bias, build.weights(layer.name + ".bias", spec.channels));
  build.add(layer, for_element(spec.type, [&](auto element) -> std::unique_ptr<Kernel> {
              return std::make_unique<LayerNormKernel<decltype(element)>>(weight, bias);
            }));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

using namespace engine;
using model::Layer, model::LayerShape;

HWY_EXPORT(PlanLayerNorm);

namespace {

/// Adds the position code. One block is one row.
template <class Element>
class PositionCodeKernel final : public Kernel {
 public:
  explicit PositionCodeKernel(size_t channels) : channels_(channels) {
    for (size_t c = 0; c < channels; c += 2) {
      frequencies_.push_back(std::pow(10000.0, -static_cast<double>(c) / static_cast<double>(channels)));
      steps_.push_back(std::polar(1.0, frequencies_.back()));
    }
  }

  std::string describe() const override { return "position code"; }
  bool needs_whole_rows() const override { return true; }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const size_t y = strip.begin + block, step = padded_channels(channels_);
    const auto* from = strip.inputs[0].row<const Element>(static_cast<ptrdiff_t>(y));
    auto* to = strip.output.row<Element>(static_cast<ptrdiff_t>(y));
    std::copy_n(from, strip.width * step, to);
    for (size_t i = 0; i < steps_.size(); ++i) {
      // The code rotates by a constant angle from pixel to pixel. In double precision, the rotations along a row are
      // accurate beyond float32, so that sines and cosines are evaluated only once per row.
      auto code = std::polar(1.0, static_cast<double>(y * strip.width) * frequencies_[i]);
      const double turn_cos = steps_[i].real(), turn_sin = steps_[i].imag();
      for (size_t x = 0; x < strip.width; ++x) {
        Element* pixel = to + x * step + 2 * i;
        assign(to_float(pixel[0]) + static_cast<float>(code.imag()), pixel[0]);
        if (2 * i + 1 < channels_) assign(to_float(pixel[1]) + static_cast<float>(code.real()), pixel[1]);
        code = {code.real() * turn_cos - code.imag() * turn_sin, code.real() * turn_sin + code.imag() * turn_cos};
      }
    }
  }

 private:
  size_t channels_;
  std::vector<double> frequencies_;
  std::vector<std::complex<double>> steps_;
};

}  // namespace

engine::Operation layer_norm() {
  return {
      .model =
          {.name = VideoOp::kLayerNorm,
           .shape = model::equal_shapes,
           .weights =
               [](const Layer& layer, std::span<const LayerShape> inputs) {
                 const std::vector<size_t> shape = {inputs[0].channels};
                 return std::vector<model::WeightShape>{{layer.name + ".weight", shape}, {layer.name + ".bias", shape}};
               }},
      .plan = [](PlanBuilder& build, const Layer& layer) { return HWY_DYNAMIC_DISPATCH(PlanLayerNorm)(build, layer); }};
}

engine::Operation position_code() {
  return {.model = {.name = VideoOp::kPositionCode,
                    .shape = model::equal_shapes,
                    .reach = [](const Layer&) { return model::kWholeImage; }},
          .plan = [](PlanBuilder& build, const Layer& layer) -> Result<void> {
            const TensorSpec& spec = build.spec(layer.name);
            build.add(layer, with_element(spec.type, [&](auto element) -> std::unique_ptr<Kernel> {
                        return std::make_unique<PositionCodeKernel<decltype(element)>>(spec.channels);
                      }));
            return {};
          }};
}

}  // namespace e2lf::video
#endif
