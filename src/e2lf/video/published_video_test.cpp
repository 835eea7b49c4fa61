// SPDX-License-Identifier: MIT
// Checkpoints of published networks, imported and run by the engine, against the published order of operations in
// torch, on the tensors as they are in the checkpoint.
#include <gtest/gtest.h>
#include <torch/nn/modules/activation.h>
#include <torch/types.h>

#include "e2lf/base/text.h"
#include "e2lf/engine/engine.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/video/import_event_video.h"
#include "testing/event_video_checkpoints.h"
#include "testing/test_files.h"

namespace e2lf::video {
namespace {

using torch::Tensor;

/// The layers that these networks share, by the keys of their tensors.
class Published {
 public:
  Published(const Safetensors& checkpoint, std::string prefix) : checkpoint_(checkpoint), prefix_(std::move(prefix)) {}
  virtual ~Published() = default;

  /// The picture of the next voxel grid.
  virtual Tensor next(const Tensor& grid) = 0;

 protected:
  [[nodiscard]] bool has(const std::string& key) const { return checkpoint_.tensors.contains(prefix_ + key); }

  [[nodiscard]] Tensor tensor(const std::string& key) const {
    const auto& found = checkpoint_.tensors.at(prefix_ + key);
    const std::vector<int64_t> shape(found.shape.begin(), found.shape.end());
    return torch::tensor(found.to_float(key).value()).reshape(shape);
  }

  [[nodiscard]] Tensor conv(const std::string& key, const Tensor& x, int64_t stride, int64_t padding) const {
    const Tensor bias = has(key + ".bias") ? tensor(key + ".bias") : Tensor();
    return at::conv2d(x, tensor(key + ".weight"), bias, stride, padding);
  }

  [[nodiscard]] Tensor norm(const std::string& key, const Tensor& x) const {
    return at::batch_norm(x, tensor(key + ".weight"), tensor(key + ".bias"), tensor(key + ".running_mean"),
                          tensor(key + ".running_var"), false, 0.1, 1e-5, false);
  }

  /// A strided convolution and an LSTM.
  Tensor encoder(const std::string& key, const Tensor& input) {
    const Tensor x = torch::relu(conv(key + ".conv.conv2d", input, 2, 2));
    auto& [hidden, memory] = states_[key];
    if (!hidden.defined()) hidden = memory = torch::zeros_like(x);
    const auto gates = conv(key + ".recurrent_block.Gates", torch::cat({x, hidden}, 1), 1, 1).chunk(4, 1);
    memory = torch::sigmoid(gates[1]) * memory + torch::sigmoid(gates[0]) * torch::tanh(gates[3]);
    return hidden = torch::sigmoid(gates[2]) * torch::tanh(memory);
  }

  [[nodiscard]] static Tensor twice(const Tensor& x) {
    return at::upsample_bilinear2d(x, {2 * x.size(2), 2 * x.size(3)}, false);
  }

 private:
  const Safetensors& checkpoint_;
  std::string prefix_;
  std::map<std::string, std::pair<Tensor, Tensor>> states_;
};

class HyperE2vid final : public Published {
 public:
  explicit HyperE2vid(const Safetensors& checkpoint) : Published(checkpoint, "unetrecurrent.") {}

  Tensor next(const Tensor& grid) override {
    if (!last_.defined()) last_ = torch::zeros({1, 1, grid.size(2), grid.size(3)});
    const Tensor head = torch::relu(conv("head.conv2d", grid, 1, 2));
    Tensor x = head;
    std::vector<Tensor> skips;
    for (int i = 0; i < 3; ++i) skips.push_back(x = encoder(cat("encoders.", i), x));
    for (int i = 0; i < 2; ++i) {
      const std::string key = cat("resblocks.", i);
      x = torch::relu(conv(key + ".conv2", torch::relu(conv(key + ".conv1", x, 1, 1)), 1, 1) + x);
    }
    x = torch::relu(dynamic(twice(x + skips[2]), grid));
    x = torch::relu(conv("decoders.1.conv2d", twice(x + skips[1]), 1, 2));
    x = torch::relu(conv("decoders.2.conv2d", twice(x + skips[0]), 1, 2));
    return last_ = conv("pred.conv2d", x + head, 1, 0);
  }

 private:
  [[nodiscard]] Tensor dynamic(const Tensor& x, const Tensor& grid) const {
    const std::string key = "decoders.0.", atoms = key + "dynamic_atom_generation.", net = atoms + "bases_net.";
    const int64_t height = x.size(2), width = x.size(3), channels = x.size(1);
    Tensor context = at::upsample_bilinear2d(torch::cat({grid, last_}, 1), {height, width}, false, 0.25, 0.25);
    context = conv(key + "context_fusion.conv", context, 1, 1);
    context = torch::tanh(norm(net + "1", conv(net + "0", context, 1, 1)));
    context = torch::tanh(norm(net + "4", conv(net + "3", context, 1, 1)));
    const Tensor filters =
        torch::einsum("bmkhw,kl->bmlhw", {context.reshape({1, 6, 12, height, width}), tensor(atoms + "bases")});
    const Tensor around = at::im2col(x, {5, 5}, {1, 1}, {2, 2}, {1, 1}).reshape({1, channels, 25, height, width});
    const Tensor filtered =
        torch::einsum("bmlhw,bclhw->bcmhw", {filters, around}).reshape({1, 6 * channels, height, width});
    return at::conv2d(filtered, tensor(key + "dynamic_conv.compositional_coefficients"),
                      tensor(key + "dynamic_conv.bias"));
  }

  Tensor last_;
};

/// Tokens are [token, 1, channel], as torch's attention takes them.
class EtNet final : public Published {
 public:
  explicit EtNet(const Safetensors& checkpoint) : Published(checkpoint, "") {}

  Tensor next(const Tensor& grid) override {
    const Tensor head = torch::relu(conv("head.conv2d", grid, 1, 2));
    Tensor x = head;
    std::vector<Tensor> cells;
    for (int i = 0; i < 3; ++i) cells.push_back(x = encoder(cat("DownsampleConv.", i), x));
    const int64_t height = x.size(2), width = x.size(3);
    const std::vector<Tensor> maps = {encode(0, cells[2]), encode(1, conv("split1", cells[1], 2, 0)),
                                      encode(2, conv("split2", cells[0], 4, 0))};
    Tensor sum = maps[0] + maps[1] + maps[2];
    for (int i = 0; i < 3; ++i) sum = sum + relate(i, maps[i], maps[std::max(i - 1, 0)]);
    x = (sum / 6).permute({1, 2, 0}).reshape({1, -1, height, width});
    for (int i = 0; i < 3; ++i) {
      x = torch::relu(conv(cat("UpsampleConv.", i, ".conv2d"), twice(x + cells[2 - i]), 1, 2));
    }
    return torch::sigmoid(conv("pred.conv2d", x + head, 1, 0));
  }

 private:
  [[nodiscard]] Tensor encode(int scale, const Tensor& image) const {
    Tensor x = image.flatten(2).permute({2, 0, 1});
    x = x + positions(x.size(0), x.size(2));
    for (int i = 0; i < 3; ++i) {
      const std::string key = cat("trans_encoder", scale, ".encoder.layers.", i);
      const Tensor even = layer_norm(key + ".norm1", x);
      x = x + attend(key + ".self_attn", even, even);
      x = x + feed_forward(key, layer_norm(key + ".norm2", x));
    }
    return x;
  }

  [[nodiscard]] Tensor relate(int scale, const Tensor& target, const Tensor& memory) const {
    Tensor x = target;
    for (int i = 0; i < 2; ++i) {
      const std::string key = cat("trans_decoder", scale, ".decoder.layers.", i);
      const Tensor even = layer_norm(key + ".norm1", x);
      x = x + attend(key + ".self_attn", even, even);
      x = x + attend(key + ".cross_attn", layer_norm(key + ".norm21", x), layer_norm(key + ".norm22", memory));
      x = x + feed_forward(key, layer_norm(key + ".norm3", x));
    }
    return x;
  }

  [[nodiscard]] static Tensor positions(int64_t count, int64_t channels) {
    Tensor table = torch::zeros({count, 1, channels}, torch::kDouble);
    for (int64_t n = 0; n < count; ++n) {
      for (int64_t c = 0; c < channels; ++c) {
        const double exponent = 2.0 * static_cast<double>(c / 2) / static_cast<double>(channels);
        const double angle = static_cast<double>(n) / std::pow(10000.0, exponent);
        table[n][0][c] = c % 2 == 0 ? std::sin(angle) : std::cos(angle);
      }
    }
    return table.to(torch::kFloat);
  }

  [[nodiscard]] Tensor layer_norm(const std::string& key, const Tensor& x) const {
    return at::layer_norm(x, {x.size(2)}, tensor(key + ".weight"), tensor(key + ".bias"), 1e-5);
  }

  [[nodiscard]] Tensor linear(const std::string& key, const Tensor& x) const {
    return at::linear(x, tensor(key + ".weight"), tensor(key + ".bias"));
  }

  [[nodiscard]] Tensor feed_forward(const std::string& key, const Tensor& x) const {
    return linear(key + ".linear2", torch::relu(linear(key + ".linear1", x)));
  }

  [[nodiscard]] Tensor attend(const std::string& key, const Tensor& queries, const Tensor& memory) const {
    torch::nn::MultiheadAttention module(torch::nn::MultiheadAttentionOptions(queries.size(2), 8));
    module->eval();
    module->in_proj_weight.copy_(tensor(key + ".in_proj_weight"));
    module->in_proj_bias.copy_(tensor(key + ".in_proj_bias"));
    module->out_proj->weight.copy_(tensor(key + ".out_proj.weight"));
    module->out_proj->bias.copy_(tensor(key + ".out_proj.bias"));
    return std::get<0>(module->forward(queries, memory, memory));
  }
};

/// Three frames of both; the largest difference, of the largest value.
double largest_difference(const Safetensors& checkpoint, Published& published, int64_t height, int64_t width) {
  torch::manual_seed(11);
  torch::NoGradGuard no_grad;
  const TestFolder folder;
  EXPECT_TRUE(write_safetensors(folder / "c.safetensors", checkpoint));
  const auto model = video::import_event_video(folder / "c.safetensors").value();
  const auto engine =
      engine::Engine::create(model.network, model.weights, {.precision = engine::Precision::kFloat32}).value();
  engine::FrameState state;
  double largest = 0.0;
  for (int frame = 0; frame < 3; ++frame) {
    const Tensor grid = torch::randn({1, static_cast<int64_t>(model.bins), height, width});
    const Tensor expected = published.next(grid).contiguous();
    std::vector<float> output(static_cast<size_t>(expected.numel()));
    const auto ran = engine.run_frame({grid.data_ptr<float>(), static_cast<size_t>(grid.numel())},
                                      static_cast<size_t>(height), static_cast<size_t>(width), state, output);
    EXPECT_TRUE(ran) << ran.error().text();
    const Tensor difference = (torch::from_blob(output.data(), expected.sizes()) - expected).abs().max();
    largest = std::max(largest, (difference / expected.abs().max()).item<double>());
    EXPECT_GT(expected.std().item<double>(), 0.01) << "a picture has something in it";
  }
  ::testing::Test::RecordProperty("largest_difference", std::to_string(largest));
  return largest;
}

TEST(PublishedVideo, HyperE2vidGivesTheFramesOfItsProgram) {
  const auto checkpoint = video::unet_checkpoint({.is_dynamic = true});
  HyperE2vid published(checkpoint);
  EXPECT_LT(largest_difference(checkpoint, published, 48, 72), 2e-5);
}

TEST(PublishedVideo, EtNetGivesTheFramesOfItsProgram) {
  const auto checkpoint = video::transformer_checkpoint({});
  EtNet published(checkpoint);
  EXPECT_LT(largest_difference(checkpoint, published, 72, 104), 2e-5);
}

}  // namespace
}  // namespace e2lf::video
