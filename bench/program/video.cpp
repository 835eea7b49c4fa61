// SPDX-License-Identifier: MIT
// e2lf-bench video: measures networks that make frames of events against libtorch.
#include <algorithm>
#include <cmath>

#include "bench/program/parts.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/engine.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/terminal/progress_bar.h"
#include "e2lf/video/operations.h"
#include "e2lf/video/video_model.h"
#include "testing/event_video_networks.h"

namespace e2lf::bench {
using namespace program;
namespace {

using engine::Engine;
using engine::Precision;
using video::VideoOp;

struct VideoBench {
  size_t width = 640, height = 480;
  size_t frames = 5;                       ///< timed frames of each network, after one that warms up
  std::optional<video::VideoModel> model;  ///< empty: FireNet, E2VID's U-Net and ET-Net with random weights
};

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

/// Runs one network on one image: in float32 and, if the CPU supports it, bfloat16, relative to libtorch in float32 on
/// the same input, and the largest difference of the last frame between both in float32. The size is rounded up to
/// multiples that the network accepts.
class Bench {
 public:
  Bench(const VideoBench& options, const NamedNetwork& named) : options_(options), named_(named) {
    const size_t multiple = model::size_multiple(named.network);
    height_ = (options.height + multiple - 1) / multiple * multiple;
    width_ = (options.width + multiple - 1) / multiple * multiple;
    input_ = noise_input(named.network, height_, width_);
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
      const auto run = [&] { return engine.run_frame(input_, height_, width_, state, output_); };
      E2LF_ASSIGN_OR_RETURN(seconds.emplace_back(), seconds_of(run));
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
    TorchRuns ran = run_libtorch(named_.network, named_.weights, height_, width_, options_.frames + 1, input_, output_);
    if (!ran.absent.empty()) {
      peer["absent"] = ran.absent;
      return;
    }
    ran.seconds.erase(ran.seconds.begin());
    const Timing timing = timing_of(ran.seconds);
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

BenchReport video_report(const Json& json) {
  report::Table table{"Medians of seconds for a frame; ratios to libtorch.",
                      {{"network"},
                       {"px", true},
                       {"float32", true},
                       {"bfloat16", true},
                       {"libtorch", true},
                       {"float32 x", true},
                       {"bfloat16 x", true}},
                      {}};
  BenchReport found{"Speed of networks of frames", cat(json["threads"].get<int>(), " threads, ",
                                                       json["isa"].get<std::string>(), "; seconds for a frame")};
  constexpr const char* kKinds[] = {"float32", "bfloat16", "peer"};
  for (const Json& row : json["networks"]) {
    const std::string name = row["network"].get<std::string>();
    std::vector<report::Cell> cells = {
        report::text_cell(name),
        report::text_cell(cat(row["image"][1].get<size_t>(), "x", row["image"][0].get<size_t>()))};
    for (size_t i = 0; i < std::size(kKinds); ++i) {
      cells.push_back(row.contains(kKinds[i]) ? number_of(row[kKinds[i]], "seconds", 4) : report::Cell());
    }
    for (const char* precision : {"float32", "bfloat16"}) {
      cells.push_back(row.contains(precision) ? number_of(row[precision], "ratio_to_peer", 1) : report::Cell());
    }
    table.rows.push_back(std::move(cells));
    const Json& peer = row["peer"];
    found.note += cat(found.note.empty() ? "" : "\n", name, ": ");
    found.note += peer.contains("absent") ? cat("no peer: ", peer["absent"].get<std::string>())
                                          : cat("largest difference between libtorch and float32 ",
                                                peer["largest_difference"].get<float>());
  }
  found.tables = {std::move(table)};
  return found;
}

}  // namespace

int run_video(const std::vector<std::string>& arguments) {
  Verb verb("video", "Measure networks that make frames of events against libtorch, in the same run.",
            "e2lf-bench video --json");
  VideoBench options;
  std::filesystem::path model;
  add_size_options(verb, options.width, options.height);
  verb.app()
      .add_option("--frames", options.frames, "of each; figures are medians")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  verb.app().add_option("-m,--model", model,
                        "model file; default: FireNet, E2VID's network and ET-Net with random weights");
  const auto measure_all = [&]() -> Result<Json> {
    if (!model.empty()) {
      E2LF_ASSIGN_OR_RETURN(options.model, video::read_video_model(model));
    }
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const Json json, bench_video(options, bar.callback()));
    return json;
  };
  return run_bench(verb, arguments, measure_all, video_report);
}

}  // namespace e2lf::bench
