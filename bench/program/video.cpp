// SPDX-License-Identifier: MIT
#include "bench/program/video.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "bench/peers/torch_event_video.h"
#include "bench/program/parts.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/engine.h"
#include "e2lf/video/operations.h"
#include "testing/event_video_networks.h"

namespace e2lf::bench {
namespace {

using engine::Engine;
using engine::Precision;
using video::VideoOp;

struct NamedNetwork {
  std::string name;
  model::Network network;
  model::Weights weights;
};

std::vector<NamedNetwork> networks_of(const VideoBench& options) {
  if (options.model) return {{options.model->name, options.model->network, options.model->weights}};
  const model::Network small = video::firenet(), large = video::event_unet(), wide = video::event_transformer();
  return {{"FireNet, random weights", small, random_weights(small)},
          {"E2VID's U-Net, random weights", large, random_weights(large)},
          {"ET-Net, random weights", wide, random_weights(wide)}};
}

/// The network in the form of the peer; empty if the peer does not support one of its layers.
class PeerNetwork {
 public:
  explicit PeerNetwork(const NamedNetwork& named) : weights_(named.weights) {
    const auto shapes = model::infer_shapes(named.network).value();
    inputs_.reserve(shapes.size());
    std::map<std::string, size_t> tensors = {{"input", 0}}, channels = {{"input", named.network.input_channels}};
    for (size_t i = 0; i < shapes.size(); ++i) {
      const model::Layer& layer = named.network.layers[i];
      E2lfTorchVideoLayer peer{};
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

  [[nodiscard]] const std::vector<E2lfTorchVideoLayer>& layers() const { return layers_; }
  [[nodiscard]] const std::string& absent() const { return absent_; }

 private:
  bool set_op(const model::Layer& layer, E2lfTorchVideoLayer& peer) const {
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
  std::vector<E2lfTorchVideoLayer> layers_;
  std::string absent_;
};

/// Returns the number of multiply-adds of a frame, including those of attention.
double products(const model::Network& network, size_t height, size_t width) {
  double sum = model::macs_per_pixel(network) * static_cast<double>(height * width);
  const auto shapes = model::infer_shapes(network).value();
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (network.layers[i].op != VideoOp::kAttention) continue;
    const auto pixels = static_cast<double>(height / shapes[i].scale * (width / shapes[i].scale));
    sum += 2.0 * static_cast<double>(shapes[i].channels) * pixels * pixels;
  }
  return sum;
}

/// Runs one network on one image with e2lf and with the peer.
class Bench {
 public:
  Bench(const VideoBench& options, const NamedNetwork& named) : options_(options), named_(named) {
    const size_t multiple = model::size_multiple(named.network);
    height_ = (options.height + multiple - 1) / multiple * multiple;
    width_ = (options.width + multiple - 1) / multiple * multiple;
    const CounterRng rng(2, 0);
    input_.resize(named.network.input_channels * height_ * width_);
    for (size_t i = 0; i < input_.size(); ++i) input_[i] = static_cast<float>(rng.below(i, 17)) / 8.0F - 1.0F;
    output_.resize(height_ * width_);
  }

  Result<Json> run(const std::function<void()>& advance) {
    report_ = {{"network", named_.name},
               {"image", {height_, width_}},
               {"gmac", products(named_.network, height_, width_) / 1e9}};
    E2LF_RETURN_IF_ERROR(run_engine(Precision::kFloat32));
    advance();
    const std::vector<float> exact = output_;
    if (engine::bfloat16_supported()) {
      E2LF_RETURN_IF_ERROR(run_engine(Precision::kBfloat16));
      report_["bfloat16"]["largest_difference"] = largest_difference(exact);
    }
    advance();
    run_peer(exact);
    advance();
    return std::move(report_);
  }

 private:
  Result<void> run_engine(Precision precision) {
    E2LF_ASSIGN_OR_RETURN(const Engine engine, Engine::create(named_.network, named_.weights, {precision}));
    engine::FrameState state;
    std::vector<double> seconds;
    for (size_t i = 0; i <= options_.frames; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      E2LF_RETURN_IF_ERROR(engine.run_frame(input_, height_, width_, state, output_));
      seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    seconds.erase(seconds.begin());
    report_[word_of(precision, engine::kPrecisions)] = {{"seconds", to_json(timing_of(seconds))},
                                                        {"kernels", engine.describe()}};
    return {};
  }

  double largest_difference(const std::vector<float>& exact) const {
    double largest = 0.0;
    for (size_t i = 0; i < exact.size(); ++i) {
      largest = std::max(largest, std::abs(static_cast<double>(exact[i]) - output_[i]));
    }
    return largest;
  }

  void run_peer(const std::vector<float>& exact) {
    Json& peer = report_["peer"];
    const PeerNetwork network(named_);
    std::string absent = network.absent();
    void* const found = absent.empty() ? find_in_peer("e2lf_torch_peer.so", "e2lf_torch_event_video", absent) : nullptr;
    std::vector<double> seconds(options_.frames + 1);
    if (found != nullptr) {
      const E2lfTorchVideoJob job{network.layers().size(),
                                  network.layers().data(),
                                  named_.network.input_channels,
                                  height_,
                                  width_,
                                  seconds.size(),
                                  input_.data(),
                                  output_.data(),
                                  num_threads(),
                                  seconds.data()};
      const char* const problem = reinterpret_cast<decltype(&e2lf_torch_event_video)>(found)(&job);
      if (problem != nullptr) absent = problem;
    }
    if (!absent.empty()) {
      peer["absent"] = absent;
      return;
    }
    seconds.erase(seconds.begin());
    const Timing timing = timing_of(seconds);
    peer = {
        {"name", "libtorch float32"}, {"seconds", to_json(timing)}, {"largest_difference", largest_difference(exact)}};
    for (const char* precision : {"float32", "bfloat16"}) {
      if (!report_.contains(precision)) continue;
      report_[precision]["ratio_to_peer"] = timing.median / report_[precision]["seconds"]["median"].get<double>();
    }
  }

  const VideoBench& options_;
  const NamedNetwork& named_;
  size_t height_ = 0, width_ = 0;
  std::vector<float> input_, output_;
  Json report_;
};

}  // namespace

Result<Json> bench_video(const VideoBench& options, const ProgressFn& progress) {
  const std::vector<NamedNetwork> networks = networks_of(options);
  Json report = {{"threads", num_threads()}, {"isa", current_isa()}, {"networks", Json::array()}};
  size_t done = 0;
  for (const NamedNetwork& named : networks) {
    Bench bench(options, named);
    E2LF_ASSIGN_OR_RETURN(Json row, bench.run([&] {
      if (progress) progress(++done, 3 * networks.size());
    }));
    report["networks"].push_back(std::move(row));
  }
  return report;
}

}  // namespace e2lf::bench
