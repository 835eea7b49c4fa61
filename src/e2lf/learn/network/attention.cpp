// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/attention.h"

#include <cmath>

namespace e2lf::learn {

torch::Tensor attend(const torch::Tensor& queries, const torch::Tensor& keys, const torch::Tensor& values,
                     int64_t heads) {
  // [batch, head, pixel, channel]
  const auto parts = [heads](const torch::Tensor& x) {
    return x.reshape({x.size(0), heads, x.size(1) / heads, x.size(2) * x.size(3)}).transpose(2, 3);
  };
  const auto scale = 1.0 / std::sqrt(static_cast<double>(queries.size(1) / heads));
  const auto scores = torch::matmul(parts(queries) * scale, parts(keys).transpose(2, 3));
  const auto sums = torch::matmul(torch::softmax(scores, 3), parts(values));
  return sums.transpose(2, 3).reshape(values.sizes());
}

torch::Tensor normalise_pixels(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias) {
  return at::layer_norm(x.permute({0, 2, 3, 1}), {x.size(1)}, weight, bias, 1e-5).permute({0, 3, 1, 2});
}

torch::Tensor add_position_code(const torch::Tensor& x) {
  const int64_t channels = x.size(1), pixels = x.size(2) * x.size(3);
  const auto options = torch::device(x.device()).dtype(torch::kDouble);
  const auto pairs = torch::arange((channels + 1) / 2, options);
  const auto angles =
      torch::outer(torch::pow(10000.0, pairs * (-2.0 / static_cast<double>(channels))), torch::arange(pixels, options));
  const auto code = torch::stack({torch::sin(angles), torch::cos(angles)}, 1).reshape({-1, x.size(2), x.size(3)});
  return x + code.slice(0, 0, channels).to(x.scalar_type());
}

}  // namespace e2lf::learn
