// SPDX-License-Identifier: MIT
// Weighted sums of neighbouring pixels; see VideoOp::kUpsampleBilinear and VideoOp::kDynamicFilter.
#include <algorithm>
#include <limits>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/engine/conv.h"
#include "e2lf/model/onnx/onnx_export.h"
#include "e2lf/video/operations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/filter_operations.cpp"
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

/// Applies the filters of each pixel. One block is one row.
template <class Element>
class DynamicFilterKernel final : public Kernel {
 public:
  DynamicFilterKernel(size_t channels, size_t filter_values, size_t kernel)
      : channels_(channels), filters_(filter_values / (kernel * kernel)), kernel_(kernel) {}

  std::string describe() const override { return std::string("dynamic filter ") + hwy::TargetName(HWY_TARGET); }
  Reach reach() const override { return {kernel_ / 2, kernel_ / 2, 1, 1}; }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const size_t y = strip.begin + block;
    const size_t out_step = padded_channels(filters_ * channels_);
    const size_t filter_step = padded_channels(filters_ * kernel_ * kernel_);
    const auto* filters = strip.inputs[1].row<const Element>(static_cast<ptrdiff_t>(y));
    auto* output = strip.output.row<Element>(static_cast<ptrdiff_t>(y));
    for (size_t x = 0; x < strip.width; ++x) {
      Element* pixel = output + x * out_step;
      for (size_t m = 0; m < filters_; ++m) {
        filter_pixel(strip, y, x, filters + x * filter_step + m * kernel_ * kernel_, pixel + m * channels_);
      }
      std::fill(pixel + filters_ * channels_, pixel + out_step, Element{});
    }
  }

 private:
  /// Applies one filter to all channels.
  HWY_INLINE void filter_pixel(const Strip& strip, size_t y, size_t x, const Element* filter, Element* to) const {
    constexpr size_t kVectors = 4;
    size_t c = 0;
    for (; c + kVectors * kLanes <= channels_; c += kVectors * kLanes) add_taps<kVectors>(strip, y, x, filter, c, to);
    for (; c < channels_; c += kLanes) add_taps<1>(strip, y, x, filter, c, to);
  }

  template <size_t kVectors>
  HWY_INLINE void add_taps(const Strip& strip, size_t y, size_t x, const Element* filter, size_t c, Element* to) const {
    const FloatTag d;
    const size_t in_step = padded_channels(channels_);
    const auto radius = static_cast<ptrdiff_t>(kernel_ / 2);
    FloatVec sums[kVectors];
    E2LF_UNROLL
    for (size_t i = 0; i < kVectors; ++i) sums[i] = hn::Zero(d);
    for (size_t dy = 0; dy < kernel_; ++dy) {
      const auto* row = strip.inputs[0].template row<const Element>(static_cast<ptrdiff_t>(y + dy) - radius);
      const auto* from = row + (static_cast<ptrdiff_t>(x) - radius) * static_cast<ptrdiff_t>(in_step) + c;
      for (size_t dx = 0; dx < kernel_; ++dx, from += in_step) {
        const auto weight = hn::Set(d, to_float(filter[dy * kernel_ + dx]));
        E2LF_UNROLL
        for (size_t i = 0; i < kVectors; ++i) sums[i] = hn::MulAdd(weight, load_floats(from + i * kLanes), sums[i]);
      }
    }
    if (c + kVectors * kLanes > channels_) {
      // The lanes of the padding are not stored, because the result of the next filter or another pixel is at their
      // place.
      Element lanes[kLanes];
      store_floats(sums[0], lanes);
      std::copy_n(lanes, channels_ - c, to + c);
      return;
    }
    E2LF_UNROLL
    for (size_t i = 0; i < kVectors; ++i) store_floats(sums[i], to + c + i * kLanes);
  }

  size_t channels_, filters_, kernel_;
};

}  // namespace

Result<void> PlanBilinear(PlanBuilder& build, const model::Layer& layer) {
  const TensorSpec& spec = build.spec(layer.name);
  build.add(layer, for_element(spec.type, [&](auto element) -> std::unique_ptr<Kernel> {
              return std::make_unique<BilinearKernel<decltype(element)>>(spec.channels, layer.stride, layer.relu);
            }));
  return {};
}

Result<void> PlanDynamicFilter(PlanBuilder& build, const model::Layer& layer) {
  const size_t channels = build.spec(layer.inputs[0]).channels, filter_values = build.spec(layer.inputs[1]).channels;
  build.add(layer, for_element(build.spec(layer.name).type, [&](auto element) -> std::unique_ptr<Kernel> {
              return std::make_unique<DynamicFilterKernel<decltype(element)>>(channels, filter_values, layer.kernel);
            }));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

using model::Layer, model::LayerShape;

HWY_EXPORT(PlanBilinear);
HWY_EXPORT(PlanDynamicFilter);

namespace {

Result<LayerShape> filter_shape(const Layer& layer, std::span<const LayerShape> inputs) {
  E2LF_RETURN_IF_ERROR(model::check_kernel(layer));
  const LayerShape input = inputs[0], filters = inputs[1];
  const size_t taps = layer.kernel * layer.kernel;
  if (filters.scale == input.scale && filters.channels % taps == 0) {
    return LayerShape{filters.channels / taps * input.channels, input.scale};
  }
  return fail(ErrorCode::kShape, "", "filters of ", filters.channels, " channels at scale ", filters.scale,
              ", not of a multiple of ", taps, " at ", input.scale,
              "; make as many as the kernel has taps, of the same resolution");
}

}  // namespace

engine::Operation bilinear_upsampling() {
  return {.model = {.name = VideoOp::kUpsampleBilinear,
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
          .plan = [](engine::PlanBuilder& build, const Layer& layer) {
            return HWY_DYNAMIC_DISPATCH(PlanBilinear)(build, layer);
          }};
}

engine::Operation dynamic_filter() {
  return {.model = {.name = VideoOp::kDynamicFilter,
                    .min_inputs = 2,
                    .max_inputs = 2,
                    .shape = filter_shape,
                    .macs =
                        [](const Layer&, std::span<const LayerShape> inputs) {
                          return static_cast<double>(inputs[0].channels * inputs[1].channels);
                        },
                    .reach = [](const Layer& layer) { return layer.kernel / 2; }},
          .plan = [](engine::PlanBuilder& build, const Layer& layer) {
            return HWY_DYNAMIC_DISPATCH(PlanDynamicFilter)(build, layer);
          }};
}

}  // namespace e2lf::video
#endif
