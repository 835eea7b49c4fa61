// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {
namespace {

struct Case {
  int64_t images, in, out, height, width;
  bool residual, relu;
};

/// Result and gradients of a convolution, in the order y, dx, dweight, dbias, dresidual.
template <class Convolution>
std::vector<torch::Tensor> run(const Case& c, torch::ScalarType type, const Convolution& convolution) {
  torch::manual_seed(7);
  const auto leaf = [&](at::IntArrayRef sizes) { return torch::randn(sizes).to(type).set_requires_grad(true); };
  const auto x = leaf({c.images, c.in, c.height, c.width}), weight = leaf({c.out, c.in, 3, 3}), bias = leaf({c.out});
  const auto residual = c.residual ? leaf({c.images, c.out, c.height, c.width}) : torch::Tensor();
  const auto y = convolution(x, weight, bias, residual);
  y.backward(torch::randn({c.images, c.out, c.height, c.width}).to(type));
  std::vector<torch::Tensor> all = {y.detach(), x.grad(), weight.grad(), bias.grad()};
  if (c.residual) all.push_back(residual.grad());
  return all;
}

class Conv3x3Test : public ::testing::Test {
 protected:
  void TearDown() override {
    set_max_isa("").value();
    at::set_num_threads(threads_);
  }

 private:
  int threads_ = at::get_num_threads();
};

TEST_F(Conv3x3Test, EqualsPlainConvolutionInDoubleForEveryInstructionSetForwardAndBackward) {
  const std::vector<Case> cases = {{1, 1, 1, 1, 1, false, false},    {2, 3, 17, 5, 9, false, true},
                                   {3, 48, 48, 8, 12, true, false},  {1, 64, 20, 4, 4, false, true},
                                   {5, 36, 70, 16, 7, false, false}, {4, 128, 128, 8, 8, true, false}};
  for (const Case& c : cases) {
    const auto expected =
        run(c, torch::kDouble, [&](const auto& x, const auto& weight, const auto& bias, const auto& residual) {
          auto y = at::conv2d(x, weight, bias, 1, 1);
          if (residual.defined()) y = y + residual;
          return c.relu ? torch::relu(y) : y;
        });
    for (const std::string& isa : available_isas()) {
      set_max_isa(isa).value();
      for (const int threads : {1, 2}) {
        at::set_num_threads(threads);
        const auto result =
            run(c, torch::kFloat, [&](const auto& x, const auto& weight, const auto& bias, const auto& r) {
              return conv3x3(x, weight, bias, r, c.relu);
            });
        ASSERT_EQ(result.size(), expected.size());
        for (size_t i = 0; i < result.size(); ++i) {
          const auto scale = expected[i].abs().max().item<double>();
          EXPECT_LT((result[i] - expected[i]).abs().max().item<double>(), 2e-5 * scale)
              << isa << ", " << threads << " threads, tensor " << i << ", " << c.in << " to " << c.out << " channels";
        }
      }
    }
  }
}

TEST_F(Conv3x3Test, TheGradientOfItsInputIsLeftOutWhereNobodyNeedsIt) {
  const auto weight = torch::randn({4, 4, 3, 3}).set_requires_grad(true);
  const auto x = torch::randn({1, 4, 8, 8});
  conv3x3(x, weight, torch::zeros({4}), {}, false).sum().backward();
  EXPECT_FALSE(x.grad().defined());
  EXPECT_TRUE(weight.grad().defined());
}

}  // namespace
}  // namespace e2lf::learn
