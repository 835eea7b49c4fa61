// SPDX-License-Identifier: MIT
#include "e2lf/learn/events/input_form.h"

#include <torch/nn/functional/upsampling.h>

namespace e2lf::learn {
namespace {

/// Returns the sign of the last non-zero count up to each transition, or 0 before the first.
torch::Tensor last_change(const torch::Tensor& events) {
  std::vector<torch::Tensor> signs;
  for (int64_t k = 0; k < events.size(1); ++k) {
    const auto now = torch::sign(events.select(1, k).detach());
    signs.push_back(k == 0 ? now : torch::where(now == 0, signs.back(), now));
  }
  return torch::stack(signs, 1);
}

/// Computes the views of a lens-array image by bilinear interpolation between the centres of the lenses.
torch::Tensor lens_views(const torch::Tensor& image) {
  namespace functional = torch::nn::functional;
  const std::vector<int64_t> size = {image.size(2), image.size(3)};
  return functional::interpolate(
      torch::pixel_unshuffle(image, capture::kLensPixels),
      functional::InterpolateFuncOptions().size(size).mode(torch::kBilinear).align_corners(false));
}

}  // namespace

torch::Tensor form_inputs(const torch::Tensor& events, const std::vector<model::InputGroup>& groups,
                          const SampleConstants& constants, const torch::Tensor& images) {
  std::vector<torch::Tensor> channels;
  for (const model::InputGroup& group : groups) {
    switch (group.kind) {
      case model::InputKind::kCounts:
        channels.push_back(events * group.scale);
        break;
      case model::InputKind::kCumulative:
        channels.push_back(events.cumsum(1) * group.scale);
        break;
      case model::InputKind::kIntensity: {
        const auto eps = constants.eps.unsqueeze(1), tau = constants.tau.unsqueeze(1);
        const auto level = events.cumsum(1) + 0.5 * last_change(events);
        // A coded intensity is at most 1: the exponential of a noisy count must not dominate its neighbours. Limiting
        // the exponent instead of the result keeps the gradient finite.
        const auto exponent = torch::minimum(tau * level, torch::log1p(eps.reciprocal()));
        channels.push_back(eps * torch::expm1(exponent) * group.scale);
        break;
      }
      case model::InputKind::kCamera: {
        const auto planes = constants.conditioning.unsqueeze(2).unsqueeze(3) * group.scale;
        channels.push_back(planes.expand({-1, -1, events.size(2), events.size(3)}).to(events.scalar_type()));
        break;
      }
      case model::InputKind::kImages:
      case model::InputKind::kImageSum:
        channels.push_back(images * group.scale);
        break;
      case model::InputKind::kLensArray:
        channels.push_back(lens_views(images) * group.scale);
        break;
    }
  }
  return torch::cat(channels, 1);
}

std::vector<InputOrigin> input_origins(const model::Model& start, const std::vector<model::InputGroup>& groups,
                                       size_t num_patterns) {
  std::vector<InputOrigin> origins;
  for (const model::InputGroup& group : groups) {
    size_t first = 0;
    auto source = start.input.begin();
    for (; source != start.input.end() && source->kind != group.kind; ++source) {
      first += model::num_input_channels({*source}, start.num_patterns);
    }
    const bool found = source != start.input.end();
    const size_t known = found ? model::num_input_channels({*source}, start.num_patterns) : 0;
    for (size_t k = 0; k < model::num_input_channels({group}, num_patterns); ++k) {
      origins.push_back(k < known ? InputOrigin{first + k, source->scale / group.scale} : InputOrigin{});
    }
  }
  return origins;
}

}  // namespace e2lf::learn
