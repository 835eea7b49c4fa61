// SPDX-License-Identifier: MIT
#include "bench/program/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <sys/resource.h>

#include "bench/peers/onednn_recnet.h"
#include "bench/peers/onnx_runtime.h"
#include "bench/peers/torch_recnet.h"
#include "bench/program/parts.h"
#include "bench/program/peak.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/engine.h"
#include "e2lf/info/describe.h"

namespace e2lf::bench {
namespace {

using engine::Engine;
using engine::Precision;

model::Model paper_model() {
  model::Model model;
  model.name = "the paper's network, random weights";
  model.num_patterns = 4;
  model.input = {{model::InputKind::kCounts, 1.0F / 8.0F}};
  model.network = model::recnet(3);
  model.weights = random_weights(model.network);
  return model;
}

double peak_memory_mib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// The signal over the difference, in decibels.
double snr_db(const std::vector<float>& signal, const std::vector<float>& other) {
  double squares = 0.0;
  double errors = 0.0;
  for (size_t i = 0; i < signal.size(); ++i) {
    squares += static_cast<double>(signal[i]) * signal[i];
    errors += (static_cast<double>(signal[i]) - other[i]) * (static_cast<double>(signal[i]) - other[i]);
  }
  return 10.0 * std::log10(squares / errors);
}

class Bench {
 public:
  Bench(const ReconstructBench& options, const ProgressFn& progress)
      : options_(options), progress_(progress), model_(options.model ? *options.model : paper_model()) {
    const size_t pixels = options_.height * options_.width;
    operations_ = 2.0 * model::macs_per_pixel(model_.network) * static_cast<double>(pixels);
    const CounterRng rng(2, 0);
    input_.resize(model_.network.input_channels * pixels);
    for (size_t i = 0; i < input_.size(); ++i) input_[i] = static_cast<float>(rng.below(i, 17)) / 8.0F - 1.0F;
    output_.resize(model::infer_shapes(model_.network).value().back().channels * pixels);
  }

  Result<Json> run() {
    const Peak peak = measure_peak();
    peak_flops_ = {{Precision::kFloat32, peak.float32_flops},
                   {Precision::kBfloat16, peak.bfloat16_flops},
                   {Precision::kInt16, peak.float32_flops}};
    report_ = {{"network", model_.name},    {"image", {options_.height, options_.width}},
               {"threads", num_threads()},  {"isa", current_isa()},
               {"gmac", operations_ / 2e9}, {"peak_gflops", {{"float32", peak.float32_flops / 1e9}}}};
    E2LF_RETURN_IF_ERROR(run_engine(Precision::kFloat32));
    report_["peak_memory_mib"] = peak_memory_mib();
    exact_ = output_;
    if (engine::bfloat16_supported()) {
      report_["peak_gflops"]["bfloat16"] = peak.bfloat16_flops / 1e9;
      E2LF_RETURN_IF_ERROR(run_engine(Precision::kBfloat16));
    }
    if (engine::int16_supported()) E2LF_RETURN_IF_ERROR(run_engine(Precision::kInt16));
    Json& peers = report_["peers"];
    peers["onednn"] = run_onednn();  // before libtorch, which uses oneDNN without its limit of the instruction set
    peers["libtorch"] = run_libtorch();
    if (!options_.onnx_packages.empty()) peers["onnx_runtime"] = run_onnx_runtime();
    for (const auto& [name, peer] : peers.items()) add_ratios("times_" + name, peer);
    return std::move(report_);
  }

 private:
  void advance() {
    const size_t precisions = 1 + (engine::bfloat16_supported() ? 1 : 0) + (engine::int16_supported() ? 1 : 0);
    if (progress_) progress_(++done_, options_.runs * precisions);
  }

  Result<void> run_engine(Precision precision) {
    E2LF_ASSIGN_OR_RETURN(const Engine engine, Engine::create(model_.network, model_.weights, {precision}));
    std::vector<double> seconds;
    for (size_t i = 0; i < options_.runs; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      E2LF_RETURN_IF_ERROR(engine.run(input_, options_.height, options_.width, output_));
      seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      advance();
    }
    Json row = speed(precision, seconds);
    row["kernels"] = engine.describe();
    if (precision != Precision::kFloat32) row["snr_to_float32_db"] = snr_db(exact_, output_);
    report_[word_of(precision, engine::kPrecisions)] = row;
    return {};
  }

  Json speed(Precision precision, const std::vector<double>& seconds) const {
    const Timing timing = timing_of(seconds);
    return {{"seconds", to_json(timing)},
            {"gflops", operations_ / timing.median / 1e9},
            {"share_of_peak", operations_ / timing.median / peak_flops_.at(precision)}};
  }

  void add_ratios(const std::string& name, const Json& peer) {
    for (const char* precision : {"float32", "bfloat16", "int16"}) {
      const Json& theirs = peer.contains(precision) ? peer[precision] : peer.value("float32", Json());
      if (!report_.contains(precision) || theirs.is_null()) continue;
      Json& own = report_[precision];
      own[name] = theirs["seconds"]["median"].get<double>() / own["seconds"]["median"].get<double>();
    }
  }

  Json run_onnx_runtime() const {
    const auto ran = bench::run_onnx_runtime(model_, options_.height, options_.width, options_.runs, num_threads(),
                                             options_.onnx_packages);
    if (!ran) return {{"absent", ran.error().text()}};
    return {{"name", ran->name}, {"float32", speed(Precision::kFloat32, ran->seconds)}};
  }

  /// The function of a peer for the paper's network; if there is none, null with the reason.
  template <class Function>
  Function* find(const char* module, const char* function, std::string& absent) const {
    if (model_.network != model::recnet(model_.network.input_channels)) {
      absent = "the peer knows only the paper's network";
      return nullptr;
    }
    return reinterpret_cast<Function*>(find_in_peer(module, function, absent));
  }

  Json run_libtorch() {
    std::string absent;
    const auto recnet = find<decltype(e2lf_torch_recnet)>("e2lf_torch_peer.so", "e2lf_torch_recnet", absent);
    const auto version = find<decltype(e2lf_torch_version)>("e2lf_torch_peer.so", "e2lf_torch_version", absent);
    if (recnet == nullptr || version == nullptr) return {{"absent", absent}};
    const Json row = run_peer(Precision::kFloat32, recnet);
    if (row.contains("absent")) return row;
    return {{"name", cat("libtorch ", version())}, {"float32", row}};
  }

  Json run_onednn() {
    std::string absent;
    const auto recnet = find<decltype(e2lf_onednn_recnet)>("e2lf_onednn_peer.so", "e2lf_onednn_recnet", absent);
    const auto version = find<decltype(e2lf_onednn_version)>("e2lf_onednn_peer.so", "e2lf_onednn_version", absent);
    if (recnet == nullptr || version == nullptr) return {{"absent", absent}};
    Json peer = {{"name", cat("oneDNN ", version())}};
    for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
      const int bfloat16 = precision == Precision::kBfloat16 ? 1 : 0;
      if (bfloat16 != 0 && !engine::bfloat16_supported()) continue;
      const Json row =
          run_peer(precision, [&](const E2lfRecnetJob* job) { return recnet(job, bfloat16, current_isa().c_str()); });
      if (row.contains("absent")) return row;
      peer[word_of(precision, engine::kPrecisions)] = row;
    }
    return peer;
  }

  template <class Recnet>
  Json run_peer(Precision precision, const Recnet& recnet) {
    std::vector<size_t> out_channels, kernels;
    std::vector<const float*> weights, biases;
    for (const model::Layer& layer : model_.network.layers) {
      out_channels.push_back(layer.out_channels);
      kernels.push_back(layer.kernel);
      weights.push_back(model_.weights.at(layer.name + ".weight").data());
      biases.push_back(model_.weights.at(layer.name + ".bias").data());
    }
    std::vector<double> seconds(options_.runs);
    const E2lfRecnetJob job{weights.size(),  out_channels.data(), kernels.data(),
                            weights.data(),  biases.data(),       model_.network.input_channels,
                            options_.height, options_.width,      input_.data(),
                            output_.data(),  num_threads(),       options_.runs,
                            seconds.data()};
    if (const char* error = recnet(&job)) return {{"absent", error}};
    Json row = speed(precision, seconds);
    row["snr_to_float32_db"] = snr_db(exact_, output_);
    return row;
  }

  const ReconstructBench& options_;
  const ProgressFn& progress_;
  model::Model model_;
  double operations_ = 0.0;
  std::map<Precision, double> peak_flops_;
  std::vector<float> input_, output_, exact_;  ///< exact_: of the engine in float32
  size_t done_ = 0;
  Json report_;
};

Result<void> check(const ReconstructBench& options) {
  const size_t multiple = options.model ? model::size_multiple(options.model->network) : 1;
  for (const auto& [name, size] : {std::pair("--width", options.width), std::pair("--height", options.height)}) {
    if (size > 0 && size % multiple == 0) continue;
    return Error{ErrorCode::kInvalidValue, cat(size, " pixels; this network needs a multiple of ", multiple), name};
  }
  if (options.runs > 0) return {};
  return Error{ErrorCode::kInvalidValue, "the number of runs must be at least 1", "--runs"};
}

}  // namespace

Result<Json> bench_reconstruct(const ReconstructBench& options, const ProgressFn& progress) {
  E2LF_RETURN_IF_ERROR(check(options));
  return Bench(options, progress).run();
}

}  // namespace e2lf::bench
