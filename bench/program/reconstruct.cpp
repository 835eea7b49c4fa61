// SPDX-License-Identifier: MIT
#include "bench/program/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sys/resource.h>

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
    report_ = {{"network", model_.name},    {"image", {options_.height, options_.width}},
               {"threads", num_threads()},  {"isa", current_isa()},
               {"gmac", operations_ / 2e9}, {"peak_gflops", {{"float32", peak.float32_flops / 1e9}}}};
    E2LF_RETURN_IF_ERROR(run_engine(Precision::kFloat32, peak.float32_flops));
    report_["peak_memory_mib"] = peak_memory_mib();
    const std::vector<float> exact = options_.with_peer || num_precisions() > 1 ? output_ : std::vector<float>();
    if (engine::bfloat16_supported()) {
      report_["peak_gflops"]["bfloat16"] = peak.bfloat16_flops / 1e9;
      E2LF_RETURN_IF_ERROR(run_engine(Precision::kBfloat16, peak.bfloat16_flops));
      report_["bfloat16"]["snr_to_float32_db"] = snr_db(exact, output_);
    }
    if (engine::int16_supported()) {
      E2LF_RETURN_IF_ERROR(run_engine(Precision::kInt16, peak.float32_flops));
      report_["int16"]["snr_to_float32_db"] = snr_db(exact, output_);
    }
    if (options_.with_peer) run_peer(exact);
    if (!options_.onnx_packages.empty()) compare_with_onnx_runtime();
    return std::move(report_);
  }

 private:
  static size_t num_precisions() {
    return 1 + (engine::bfloat16_supported() ? 1 : 0) + (engine::int16_supported() ? 1 : 0);
  }

  void advance() {
    const size_t total = options_.runs * (num_precisions() + (options_.with_peer ? 1 : 0));
    if (progress_) progress_(++done_, total);
  }

  Result<void> run_engine(Precision precision, double peak_flops) {
    E2LF_ASSIGN_OR_RETURN(const Engine engine, Engine::create(model_.network, model_.weights, {precision}));
    std::vector<double> seconds;
    for (size_t i = 0; i < options_.runs; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      E2LF_RETURN_IF_ERROR(engine.run(input_, options_.height, options_.width, output_));
      seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      advance();
    }
    const Timing timing = timing_of(seconds);
    report_[word_of(precision, engine::kPrecisions)] = {{"seconds", to_json(timing)},
                                                        {"gflops", operations_ / timing.median / 1e9},
                                                        {"share_of_peak", operations_ / timing.median / peak_flops},
                                                        {"kernels", engine.describe()}};
    return {};
  }

  void compare_with_onnx_runtime() {
    Json& peer = report_["onnx_runtime"];
    const auto ran =
        run_onnx_runtime(model_, options_.height, options_.width, options_.runs, num_threads(), options_.onnx_packages);
    if (!ran) {
      peer["absent"] = ran.error().text();
      return;
    }
    const Timing timing = timing_of(ran->seconds);
    peer = {{"name", ran->name}, {"seconds", to_json(timing)}, {"gflops", operations_ / timing.median / 1e9}};
    add_ratios("ratio_to_onnx_runtime", timing);
  }

  void add_ratios(const char* name, const Timing& peer) {
    for (const char* precision : {"float32", "bfloat16", "int16"}) {
      if (!report_.contains(precision)) continue;
      Json& own = report_[precision];
      own[name] = peer.median / own["seconds"]["median"].get<double>();
    }
  }

  std::string peer_refusal() const {
    return model_.network == model::recnet(model_.network.input_channels) ? ""
                                                                          : "the peer knows only the paper's network";
  }

  void run_peer(const std::vector<float>& exact) {
    Json& peer = report_["peer"];
    peer["absent"] = peer_refusal();
    if (peer["absent"] != "") return;
    std::string absent;
    const auto recnet = reinterpret_cast<decltype(&e2lf_torch_recnet)>(
        find_torch_peer(options_.peer_module, "e2lf_torch_recnet", absent));
    const auto version = reinterpret_cast<decltype(&e2lf_torch_version)>(
        find_torch_peer(options_.peer_module, "e2lf_torch_version", absent));
    if (recnet == nullptr || version == nullptr) {
      peer["absent"] = absent;
      return;
    }
    std::vector<double> seconds;
    for (size_t i = 0; i < options_.runs; ++i) {
      double elapsed = 0.0;
      if (const char* error = run_peer_once(recnet, elapsed)) {
        peer["absent"] = error;
        return;
      }
      seconds.push_back(elapsed);
      advance();
    }
    report_peer(version(), timing_of(seconds), exact);
  }

  const char* run_peer_once(decltype(&e2lf_torch_recnet) recnet, double& seconds) {
    std::vector<size_t> out_channels, kernels;
    std::vector<const float*> weights, biases;
    for (const model::Layer& layer : model_.network.layers) {
      out_channels.push_back(layer.out_channels);
      kernels.push_back(layer.kernel);
      weights.push_back(model_.weights.at(layer.name + ".weight").data());
      biases.push_back(model_.weights.at(layer.name + ".bias").data());
    }
    const E2lfTorchJob job{weights.size(),  out_channels.data(), kernels.data(),
                           weights.data(),  biases.data(),       model_.network.input_channels,
                           options_.height, options_.width,      input_.data(),
                           output_.data(),  num_threads(),       1,
                           &seconds};
    return recnet(&job);
  }

  void report_peer(const char* version, const Timing& timing, const std::vector<float>& exact) {
    double largest = 0.0;
    for (size_t i = 0; i < exact.size(); ++i) {
      largest = std::max(largest, std::abs(static_cast<double>(exact[i]) - output_[i]));
    }
    report_["peer"] = {{"name", cat("libtorch ", version, " float32")},
                       {"seconds", to_json(timing)},
                       {"gflops", operations_ / timing.median / 1e9},
                       {"largest_difference", largest}};
    add_ratios("ratio_to_peer", timing);
  }

  const ReconstructBench& options_;
  const ProgressFn& progress_;
  model::Model model_;
  double operations_ = 0.0;
  std::vector<float> input_, output_;
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
