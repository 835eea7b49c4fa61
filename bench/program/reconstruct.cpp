// SPDX-License-Identifier: MIT
// e2lf-bench reconstruct: measures the network against oneDNN, libtorch and the peak of the machine.
#include <algorithm>
#include <cmath>
#include <map>
#include <sys/resource.h>

#include "bench/peers/onednn_recnet.h"
#include "bench/peers/onnx_runtime.h"
#include "bench/program/parts.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/engine.h"
#include "e2lf/info/describe.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

using engine::Engine;
using engine::Precision;

struct ReconstructBench {
  size_t height = 720;
  size_t width = 1280;
  size_t runs = 3;                      ///< of each precision and of each peer; figures are medians
  std::optional<model::Model> model;    ///< absent: the paper's network for N = 4 with random weights
  std::filesystem::path onnx_packages;  ///< with the npm package onnxruntime-node, a peer; empty = without it
};

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

/// Measures the speed of the reconstruction network on an image of noise: every precision the CPU has, the machine's
/// peak in a multiply-add loop, and the peers that this build has, in this same process with the same threads: for the
/// paper's network oneDNN in float32 and bfloat16, with the instruction set in use; for networks whose layers the peer
/// knows libtorch in float32; for all networks ONNX Runtime in a process of its own. Operations count multiply-adds of
/// the network as written, twice each. Fails as Engine::create does.
///
/// {"image": [720, 1280], "threads": 2, "isa": "avx512", "gmac": 873,
///  "peak_gflops": {"float32": .., "bfloat16": ..},
///  "float32": {"seconds": {"median", "min", "max"}, "gflops", "share_of_peak", "kernels": [..], "times_onednn",
///              "times_libtorch", "times_onnx_runtime"},
///  "bfloat16": the same with "snr_to_float32_db", "int16": the same, with its share of the peak of float32,
///  "peak_memory_mib": of the process after the float32 runs,
///  "peers": {"onednn": {"name", "float32": {"seconds": {..}, "gflops", "share_of_peak", "snr_to_float32_db"},
///                       "bfloat16": {..}}, "libtorch": {..}, "onnx_runtime": {..}},
///   each {"absent": "why"} where it did not run}
/// The speed of bfloat16 is compared with that of a peer in bfloat16 if it has it, and otherwise in float32.
class Bench {
 public:
  Bench(const ReconstructBench& options, ProgressFn progress)
      : options_(options), progress_(std::move(progress)), model_(options.model ? *options.model : paper_model()) {
    const size_t pixels = options_.height * options_.width;
    operations_ = 2.0 * model::macs_per_pixel(model_.network) * static_cast<double>(pixels);
    input_ = noise_input(model_.network, options_.height, options_.width);
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
    progress_(++done_, options_.runs * precisions);
  }

  Result<void> run_engine(Precision precision) {
    E2LF_ASSIGN_OR_RETURN(const Engine engine, Engine::create(model_.network, model_.weights, {precision}));
    std::vector<double> seconds;
    for (size_t i = 0; i < options_.runs; ++i) {
      const auto run = [&] { return engine.run(input_, options_.height, options_.width, output_); };
      E2LF_ASSIGN_OR_RETURN(seconds.emplace_back(), seconds_of(run));
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

  Json run_libtorch() {
    const TorchRuns ran = bench::run_libtorch(model_.network, model_.weights, options_.height, options_.width,
                                              options_.runs, input_, output_);
    if (!ran.absent.empty()) return {{"absent", ran.absent}};
    return {{"name", ran.name}, {"float32", peer_speed(Precision::kFloat32, ran.seconds)}};
  }

  Json peer_speed(Precision precision, const std::vector<double>& seconds) const {
    Json row = speed(precision, seconds);
    row["snr_to_float32_db"] = snr_db(exact_, output_);
    return row;
  }

  Json run_onednn() {
    if (model_.network != model::recnet(model_.network.input_channels)) {
      return {{"absent", "the peer knows only the paper's network"}};
    }
    std::string absent;
    const auto find = [&](const char* function) { return find_in_peer("e2lf_onednn_peer.so", function, absent); };
    const auto recnet = reinterpret_cast<decltype(&e2lf_onednn_recnet)>(find("e2lf_onednn_recnet"));
    const auto version = reinterpret_cast<decltype(&e2lf_onednn_version)>(find("e2lf_onednn_version"));
    if (recnet == nullptr || version == nullptr) return {{"absent", absent}};
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
    Json peer = {{"name", cat("oneDNN ", version())}};
    for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
      const int bfloat16 = precision == Precision::kBfloat16 ? 1 : 0;
      if (bfloat16 != 0 && !engine::bfloat16_supported()) continue;
      if (const char* error = recnet(&job, bfloat16, current_isa().c_str())) return {{"absent", error}};
      peer[word_of(precision, engine::kPrecisions)] = peer_speed(precision, seconds);
    }
    return peer;
  }

  const ReconstructBench& options_;
  ProgressFn progress_;
  model::Model model_;
  double operations_ = 0.0;
  std::map<Precision, double> peak_flops_;
  std::vector<float> input_, output_, exact_;  ///< exact_: of the engine in float32
  size_t done_ = 0;
  Json report_;
};

BenchReport reconstruct_report(const Json& json) {
  report::Table table{"Medians. GFLOP/s count the network's multiplications and additions.",
                      {{"arithmetic"},
                       {"seconds", true},
                       {"GFLOP/s", true},
                       {"of the peak, %", true},
                       {"times oneDNN", true},
                       {"times libtorch", true},
                       {"times ONNX Runtime", true}},
                      {}};
  BenchReport found{"Speed of reconstruction",
                    cat(json["network"].get<std::string>(), ", ", json_line(json["image"]), " px, ",
                        json["threads"].get<int>(), " threads, ", json["isa"].get<std::string>())};
  const auto add = [&](const std::string& name, const Json& row) {
    table.rows.push_back({report::text_cell(name), number_of(row, "seconds", 3), number_of(row, "gflops", 0),
                          number_of(row, "share_of_peak", 0, 100), number_of(row, "times_onednn", 2),
                          number_of(row, "times_libtorch", 2), number_of(row, "times_onnx_runtime", 2)});
  };
  const auto add_precisions = [&](const std::string& name, const Json& rows) {
    for (const char* precision : {"float32", "bfloat16", "int16"}) {
      if (rows.contains(precision)) add(name + precision, rows[precision]);
    }
  };
  add_precisions("", json);
  for (const auto& [name, peer] : json["peers"].items()) {
    if (peer.contains("absent"))
      found.note += cat("no ", name, ": ", peer["absent"].get<std::string>(), "\n");
    else
      add_precisions(peer["name"].get<std::string>() + " ", peer);
  }
  found.note += cat("multiply-add peak of this machine, GFLOP/s: ", json_line(json["peak_gflops"]), "; peak memory ",
                    std::lround(json["peak_memory_mib"].get<double>()), " MiB");
  found.tables = {std::move(table)};
  return found;
}

}  // namespace

int run_reconstruct(const std::vector<std::string>& arguments) {
  Verb verb("reconstruct",
            "Measure the reconstruction network against oneDNN, libtorch and the machine's multiply-add peak, in the "
            "same run.",
            "e2lf-bench reconstruct --json");
  ReconstructBench options;
  std::filesystem::path model;
  add_size_options(verb, options.width, options.height);
  verb.app()
      .add_option("--runs", options.runs, "of each; figures are medians")
      ->check(whole_number(1))
      ->capture_default_str();
  add_model_option(verb.app(), "-m,--model", model,
                   "model file or bundled model; default: the paper's network with random weights");
  verb.app().add_option("--onnx", options.onnx_packages,
                        "measure ONNX Runtime, too: a folder in which npm has installed onnxruntime-node");
  const auto measure_all = [&]() -> Result<Json> {
    if (!model.empty()) {
      E2LF_ASSIGN_OR_RETURN(options.model, model::read_model(model));
    }
    const size_t multiple = options.model ? model::size_multiple(options.model->network) : 1;
    for (const auto& [name, size] : {std::pair("--width", options.width), std::pair("--height", options.height)}) {
      if (size % multiple == 0) continue;
      return Error{ErrorCode::kInvalidValue, cat(size, " pixels; this network needs a multiple of ", multiple), name};
    }
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const Json json, Bench(options, bar.callback()).run());
    return json;
  };
  return run_bench(verb, arguments, measure_all, reconstruct_report);
}

}  // namespace e2lf::bench
