// SPDX-License-Identifier: MIT
// The convolution of network_module.h whose gradients and values winograd_conv.h computes.
#include <ATen/Parallel.h>
#include <algorithm>

#include "e2lf/base/result.h"
#include "e2lf/learn/kernels/winograd_conv.h"
#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {
namespace {

using torch::autograd::AutogradContext, torch::autograd::variable_list;

constexpr auto kChannelsLast = at::MemoryFormat::ChannelsLast;

ConvShape shape_of(const torch::Tensor& x, const torch::Tensor& weight) {
  const auto size = [](int64_t value) { return static_cast<size_t>(value); };
  return {size(x.size(0)), size(x.size(2)), size(x.size(3)), size(weight.size(1)), size(weight.size(0))};
}

/// Transforms taps [3, 3, rows, columns] to the matrices with which the kernels multiply.
torch::Tensor matrices_of(const torch::Tensor& taps) {
  const auto dense = taps.contiguous();
  const auto rows = static_cast<size_t>(taps.size(2)), columns = static_cast<size_t>(taps.size(3));
  auto matrices = torch::empty({static_cast<int64_t>(winograd_matrices_size(rows, columns))});
  to_winograd_matrices(dense.data_ptr<float>(), rows, columns, matrices.data_ptr<float>());
  return matrices;
}

/// Calls run(share, first, end) for up to as many shares of [0, count) as there are threads.
template <class Run>
void in_shares(size_t count, size_t shares, const Run& run) {
  at::parallel_for(0, static_cast<int64_t>(shares), 1, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      run(i, count * i / shares, count * (i + 1) / shares);
    }
  });
}

size_t num_shares(size_t count) {
  return std::clamp<size_t>(static_cast<size_t>(at::get_num_threads()), 1, std::max<size_t>(count, 1));
}

class Conv3x3 : public torch::autograd::Function<Conv3x3> {
 public:
  static torch::Tensor forward(AutogradContext* context, const torch::Tensor& x, const torch::Tensor& weight,
                               const torch::Tensor& bias, const torch::Tensor& residual, bool relu) {
    const auto input = x.contiguous(kChannelsLast);
    const auto added = residual.contiguous(kChannelsLast);
    const bool has_residual = added.numel() > 0;
    const auto matrices = matrices_of(weight.permute({2, 3, 1, 0})), biases = bias.contiguous();
    const ConvShape shape = shape_of(input, weight);
    auto y = torch::empty({x.size(0), weight.size(0), x.size(2), x.size(3)}, x.options(), kChannelsLast);
    const ConvForward job{input.data_ptr<float>(),
                          matrices.data_ptr<float>(),
                          biases.data_ptr<float>(),
                          has_residual ? added.data_ptr<float>() : nullptr,
                          relu,
                          y.data_ptr<float>()};
    const size_t tiles = shape.images * tiles_per_image(shape);
    in_shares(tiles, num_shares(tiles),
              [&](size_t, size_t first, size_t end) { conv_forward(shape, job, first, end); });
    context->save_for_backward({input, weight, relu ? y : torch::Tensor()});
    context->saved_data["has_residual"] = has_residual;
    return y;
  }

  static variable_list backward(AutogradContext* context, const variable_list& gradients) {
    const auto saved = context->get_saved_variables();
    const auto &x = saved[0], &weight = saved[1], &y = saved[2];
    const auto dy = gradients[0].contiguous(kChannelsLast);
    const ConvShape shape = shape_of(x, weight);
    const auto matrices = matrices_of(weight.permute({2, 3, 0, 1}));
    auto dx = context->needs_input_grad(0) ? torch::zeros_like(x, x.options(), kChannelsLast) : torch::Tensor();
    // Each share has its own sums, which are added in order, so that the result depends only on the number of threads.
    const size_t shares = num_shares(shape.images);
    const auto size = static_cast<int64_t>(winograd_matrices_size(shape.in_channels, shape.out_channels));
    const auto count = static_cast<int64_t>(shares);
    auto dmatrices = torch::zeros({count, size}), dbias = torch::zeros({count, weight.size(0)});
    in_shares(shape.images, shares, [&](size_t share, size_t first, size_t end) {
      const auto row = static_cast<int64_t>(share);
      conv_backward(shape,
                    {x.data_ptr<float>(), matrices.data_ptr<float>(), y.defined() ? y.data_ptr<float>() : nullptr,
                     dy.data_ptr<float>(), dx.defined() ? dx.data_ptr<float>() : nullptr,
                     dmatrices[row].data_ptr<float>(), dbias[row].data_ptr<float>()},
                    first, end);
    });
    auto dtaps = torch::empty({3, 3, weight.size(1), weight.size(0)});
    const auto sum = shares == 1 ? dmatrices : dmatrices.sum(0);
    from_winograd_matrices(sum.data_ptr<float>(), shape.in_channels, shape.out_channels, dtaps.data_ptr<float>());
    const bool has_residual = context->saved_data["has_residual"].toBool();
    return {dx, dtaps.permute({3, 2, 0, 1}), dbias.sum(0), has_residual ? dy : torch::Tensor(), torch::Tensor()};
  }
};

}  // namespace

torch::Tensor conv3x3(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias,
                      const torch::Tensor& residual, bool relu) {
  E2LF_REQUIRE(!(relu && residual.defined()), "a residual and ReLU together are not supported");
  // torch's functions do not accept undefined tensors, so an empty one represents none.
  return Conv3x3::apply(x, weight, bias, residual.defined() ? residual : torch::empty({0, 0, 0, 0}), relu);
}

}  // namespace e2lf::learn
