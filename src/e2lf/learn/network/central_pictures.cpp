// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/central_pictures.h"

#include <torch/torch.h>

#include "e2lf/learn/network/geometry_operations.h"
#include "e2lf/learn/network/levels.h"

namespace e2lf::learn {
namespace {

/// All channels of the input of a network of disparity [batch, channel, y, x].
torch::Tensor all_channels(const DepthInputs& inputs) {
  const int64_t height = inputs.cycles.size(1), width = inputs.cycles.size(2);
  const auto camera = inputs.conditioning.unsqueeze(2).unsqueeze(3).repeat({1, 1, height, width});
  camera.select(1, capture::kCyclesCondition).copy_(inputs.cycles);
  return torch::cat({inputs.groups.flatten(1, 2), camera}, 1);
}

torch::Tensor matrix(const std::vector<float>& values, int64_t rows, const torch::Tensor& like) {
  return torch::tensor(at::ArrayRef<float>(values)).reshape({rows, -1}).to(like);
}

}  // namespace

model::Network picture_network(const std::vector<size_t>& widths) {
  model::Network network{model::kCentralPlanes, {}};
  LayerList layers{network};
  layers.conv("stem", "input", widths[0], 2, 2);
  network.layers.back().relu = true;
  const std::string x = add_levels(layers, layers.conv("start", "stem", widths[0], 3), widths);
  layers.add({.name = "sharp", .op = model::Op::kPixelShuffle, .inputs = {layers.conv("head", x, 4, 3)}, .stride = 2});
  return network;
}

CentralPictures move_to_centre(const DepthInputs& inputs, const torch::Tensor& disparity,
                               const std::vector<model::CentralInput>& central) {
  const auto channels = all_channels(inputs);
  std::vector<torch::Tensor> planes, bases;
  for (int64_t i = 0; i < channels.size(0); ++i) {
    const model::CentralInput& from = central[static_cast<size_t>(i)];
    const std::vector<int64_t> numbers(from.moved.begin(), from.moved.end());
    const auto own = channels[i], own_disparity = disparity[i];
    const auto pictures =
        own.index_select(0, torch::tensor(at::ArrayRef<int64_t>(numbers), torch::kLong).to(own.device()));
    const model::Layer warp = model::warp_to_centre(from.offsets);
    const auto moved = apply_warp({warp, {pictures.unsqueeze(0), own_disparity.unsqueeze(0)}, nullptr})[0];
    const auto all = torch::cat({own, moved, own_disparity}).flatten(1);
    const auto bias = matrix(from.bias, model::kCentralPlanes, all);
    planes.push_back(torch::addmm(bias, matrix(from.weight, model::kCentralPlanes, all), all)
                         .unflatten(1, {own.size(1), own.size(2)}));
    bases.push_back(torch::matmul(matrix(from.base, 1, all), moved.flatten(1)).reshape({own.size(1), own.size(2)}));
  }
  return {torch::stack(planes), torch::stack(bases)};
}

}  // namespace e2lf::learn
