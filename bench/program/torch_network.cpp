// SPDX-License-Identifier: MIT
// Runs networks in libtorch, in the module of the peer.
#include <map>

#include "bench/peers/torch_peer.h"
#include "bench/program/parts.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/video/operations.h"

namespace e2lf::bench {
namespace {

using video::VideoOp;

/// The network in the form of the peer; empty if the peer does not support one of its layers.
class PeerNetwork {
 public:
  PeerNetwork(const model::Network& network, const model::Weights& weights) : weights_(weights) {
    const auto shapes = model::infer_shapes(network).value();
    inputs_.reserve(shapes.size());
    std::map<std::string, size_t> tensors = {{"input", 0}}, channels = {{"input", network.input_channels}};
    for (size_t i = 0; i < shapes.size(); ++i) {
      const model::Layer& layer = network.layers[i];
      E2lfTorchLayer peer{};
      if (!set_op(layer, peer)) {
        absent_ = cat("the peer does not support layer ", layer.name);
        return;
      }
      std::vector<size_t>& inputs = inputs_.emplace_back();
      for (const std::string& input : layer.inputs) inputs.push_back(tensors.at(input));
      peer.inputs = inputs.data();
      peer.num_inputs = inputs.size();
      peer.residual = layer.residual.empty() ? 0 : tensors.at(layer.residual) + 1;
      peer.in_channels = channels.at(layer.inputs[0]);
      peer.out_channels = layer.out_channels;
      peer.kernel = layer.kernel;
      peer.stride = layer.stride;
      peer.heads = layer.integer("heads", 1);
      peer.relu = layer.relu ? 1 : 0;
      tensors[layer.name] = i + 1;
      channels[layer.name] = shapes[i].channels;
      layers_.push_back(peer);
    }
  }

  [[nodiscard]] const std::vector<E2lfTorchLayer>& layers() const { return layers_; }
  [[nodiscard]] const std::string& absent() const { return absent_; }

 private:
  bool set_op(const model::Layer& layer, E2lfTorchLayer& peer) const {
    static const std::map<std::string, E2lfTorchOp> known = {{VideoOp::kConv, kE2lfConv},
                                                             {VideoOp::kConvGru, kE2lfGru},
                                                             {VideoOp::kConvLstm, kE2lfLstm},
                                                             {VideoOp::kUpsampleBilinear, kE2lfBilinear},
                                                             {VideoOp::kAdd, kE2lfAdd},
                                                             {VideoOp::kMean, kE2lfMean},
                                                             {VideoOp::kLayerNorm, kE2lfLayerNorm},
                                                             {VideoOp::kPositionCode, kE2lfPositionCode},
                                                             {VideoOp::kAttention, kE2lfAttention},
                                                             {VideoOp::kSigmoid, kE2lfSigmoid}};
    const auto found = known.find(layer.op);
    if (found == known.end() || (layer.relu && layer.op != VideoOp::kConv)) return false;
    peer.op = found->second;
    if (layer.op == VideoOp::kConv || layer.op == VideoOp::kLayerNorm) set_weights(layer.name, peer.weight, peer.bias);
    if (layer.op == VideoOp::kConvGru || layer.op == VideoOp::kConvLstm) {
      set_weights(layer.name + ".gates", peer.weight, peer.bias);
    }
    if (layer.op == VideoOp::kConvGru) {
      set_weights(layer.name + ".candidate", peer.candidate_weight, peer.candidate_bias);
    }
    return true;
  }

  void set_weights(const std::string& name, const float*& weight, const float*& bias) const {
    weight = weights_.at(name + ".weight").data();
    bias = weights_.at(name + ".bias").data();
  }

  const model::Weights& weights_;
  std::vector<std::vector<size_t>> inputs_;
  std::vector<E2lfTorchLayer> layers_;
  std::string absent_;
};

}  // namespace

TorchRuns run_libtorch(const model::Network& network, const model::Weights& weights, size_t height, size_t width,
                       size_t runs, const std::vector<float>& input, std::vector<float>& output) {
  TorchRuns result;
  const PeerNetwork peer(network, weights);
  result.absent = peer.absent();
  if (!result.absent.empty()) return result;
  const auto find = [&](const char* function) { return find_in_peer("e2lf_torch_peer.so", function, result.absent); };
  const auto run = reinterpret_cast<decltype(&e2lf_torch_network)>(find("e2lf_torch_network"));
  const auto version = reinterpret_cast<decltype(&e2lf_torch_version)>(find("e2lf_torch_version"));
  if (run == nullptr || version == nullptr) return result;
  result.name = cat("libtorch ", version());
  result.seconds.resize(runs);
  const E2lfTorchNetworkJob job{
      peer.layers().size(), peer.layers().data(), network.input_channels, height, width, runs, input.data(),
      output.data(),        num_threads(),        result.seconds.data()};
  if (const char* problem = run(&job)) result.absent = problem;
  return result;
}

}  // namespace e2lf::bench
