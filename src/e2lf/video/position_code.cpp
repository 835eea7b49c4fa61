// SPDX-License-Identifier: MIT
// Codes of positions; see Op::kPositionCode.
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "e2lf/engine/conv.h"
#include "e2lf/video/operations.h"

namespace e2lf::video {

using namespace engine;
using model::Layer, model::LayerShape;

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
  Reach reach() const override { return {}; }
  bool needs_whole_rows() const override { return true; }
  size_t num_blocks(const Strip& strip) const override { return strip.end - strip.begin; }

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

Result<void> plan_position_code(PlanBuilder& build, const Layer& layer) {
  const engine::TensorSpec& spec = build.spec(layer.name);
  if (spec.type == ElementType::kFloat32) {
    build.add(layer, std::make_unique<PositionCodeKernel<float>>(spec.channels));
  } else {
    build.add(layer, std::make_unique<PositionCodeKernel<Bfloat16>>(spec.channels));
  }
  return {};
}

}  // namespace

engine::Operation position_code() {
  return {.model = {.name = Op::kPositionCode,
                    .shape = model::equal_shapes,
                    .reach = [](const Layer&) { return model::kWholeImage; }},
          .plan = plan_position_code};
}

}  // namespace e2lf::video
