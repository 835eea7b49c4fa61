// SPDX-License-Identifier: MIT
// e2lf bench reconstruct | simulate | train | video; decode is in a file of its own
#include <cmath>
#include <cstdio>

#include "bench/simulate/benchmark_simulate.h"
#include "bench/simulate/benchmark_stream.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/bench_camera.h"
#include "e2lf/cli/bench_decode.h"
#include "e2lf/cli/bench_reconstruct.h"
#include "e2lf/cli/bench_rig.h"
#include "e2lf/cli/bench_video.h"
#include "e2lf/cli/camera_option.h"
#include "e2lf/cli/number_check.h"
#include "e2lf/cli/trainer_program.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/json_text.h"
#include "e2lf/model/model.h"
#include "e2lf/streams/camera_stream.h"

namespace e2lf::cli {
namespace {

void print_precision(const std::string& name, const Json& row) {
  std::printf("%-28s %9.3f %12.0f", name.c_str(), row["seconds"]["median"].get<double>(), row["gflops"].get<double>());
  if (row.contains("share_of_peak")) std::printf(" %11.0f %%", 100 * row["share_of_peak"].get<double>());
  if (row.contains("ratio_to_peer")) std::printf(" %11.1f x", row["ratio_to_peer"].get<double>());
  std::printf("\n");
}

void print_bench_reconstruct(const Json& json) {
  std::printf("%s px, %d threads, %s\n\n", json_line(json["image"]).c_str(), json["threads"].get<int>(),
              json["isa"].get<std::string>().c_str());
  std::printf("%-28s %9s %12s %13s %13s\n", "", "seconds", "GFLOP/s", "of the peak", "to the peer");
  for (const char* precision : {"float32", "bfloat16"}) {
    if (json.contains(precision)) print_precision(precision, json[precision]);
  }
  if (json["peer"].contains("name")) {
    print_precision("peer: " + json["peer"]["name"].get<std::string>(), json["peer"]);
  } else {
    std::printf("peer: none (%s)\n", json["peer"]["absent"].get<std::string>().c_str());
  }
  std::printf("\nmultiply-add peak of this machine, GFLOP/s: %s; peak memory %.0f MiB\n",
              json_line(json["peak_gflops"]).c_str(), json["peak_memory_mib"].get<double>());
}

void add_size_options(Verb& verb, size_t& width, size_t& height) {
  const CLI::Range pixels(size_t{1}, size_t{16384});
  verb.app().add_option("--width", width, "of the image in pixels")->check(pixels)->capture_default_str();
  verb.app().add_option("--height", height, "of the image in pixels")->check(pixels)->capture_default_str();
}

int run_bench_reconstruct(const std::vector<std::string>& arguments) {
  Verb verb("bench reconstruct",
            "Measure the reconstruction network against libtorch and the machine's multiply-add peak, in the same run.",
            "e2lf bench reconstruct --json");
  ReconstructBench options;
  std::filesystem::path model;
  add_size_options(verb, options.width, options.height);
  verb.app()
      .add_option("--runs", options.runs, "of each; figures are medians")
      ->check(whole_number(1))
      ->capture_default_str();
  verb.app().add_option("-m,--model", model, "model file; default: the paper's network with random weights");
  return verb.run(arguments, [&]() -> Result<void> {
    if (!model.empty()) {
      E2LF_ASSIGN_OR_RETURN(options.model, model::read_model(model));
    }
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const Json json, bench_reconstruct(options, bar.callback()));
    hide_progress();
    if (verb.common().json) {
      std::printf("%s", json_text(json).c_str());
    } else {
      print_bench_reconstruct(json);
    }
    return {};
  });
}

void print_bench_video(const Json& json) {
  std::printf("%d threads, %s; seconds for a frame\n\n%-34s %10s %9s %9s %9s %9s %12s\n", json["threads"].get<int>(),
              json["isa"].get<std::string>().c_str(), "", "px", "float32", "bfloat16", "libtorch", "float32 x",
              "bfloat16 x");
  for (const Json& row : json["networks"]) {
    const auto number = [&](const char* what, const char* precision) -> double {
      if (!row.contains(precision) || !row[precision].contains(what)) return NAN;
      const Json& value = row[precision][what];
      return value.is_object() ? value["median"].get<double>() : value.get<double>();
    };
    const std::string size = cat(row["image"][1].get<size_t>(), "x", row["image"][0].get<size_t>());
    std::printf("%-34s %10s %9.4f %9.4f %9.4f %9.1f %12.1f\n", row["network"].get<std::string>().c_str(), size.c_str(),
                number("seconds", "float32"), number("seconds", "bfloat16"), number("seconds", "peer"),
                number("ratio_to_peer", "float32"), number("ratio_to_peer", "bfloat16"));
    if (row["peer"].contains("absent")) {
      std::printf("  no peer: %s\n", row["peer"]["absent"].get<std::string>().c_str());
    } else {
      std::printf("  largest difference between libtorch and float32: %.1g\n",
                  row["peer"]["largest_difference"].get<double>());
    }
  }
}

int run_bench_video(const std::vector<std::string>& arguments) {
  Verb verb("bench video", "Measure networks that make frames of events against libtorch, in the same run.",
            "e2lf bench video --json");
  VideoBench options;
  std::filesystem::path model;
  add_size_options(verb, options.width, options.height);
  verb.app()
      .add_option("--frames", options.frames, "of each; figures are medians")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  verb.app().add_option("-m,--model", model, "model file; default: FireNet and E2VID's network with random weights");
  return verb.run(arguments, [&]() -> Result<void> {
    if (!model.empty()) {
      E2LF_ASSIGN_OR_RETURN(options.model, model::read_video_model(model));
    }
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const Json json, bench_video(options, bar.callback()));
    hide_progress();
    if (verb.common().json) {
      std::printf("%s", json_text(json).c_str());
    } else {
      print_bench_video(json);
    }
    return {};
  });
}

int run_bench_simulate(const std::vector<std::string>& arguments) {
  Verb verb("bench simulate",
            "Measure the event simulation against the scalar reference on one thread, in the same run.",
            "e2lf bench simulate --json");
  bench::SimulationBenchmarkOptions options;
  add_size_options(verb, options.width, options.height);
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const bench::SimulationBenchmark result, bench::benchmark_simulation(options));
    RunRecord record("bench simulate");
    E2LF_ASSIGN_OR_RETURN(const capture::Camera camera, load_camera("evk4-lcos", record));
    E2LF_ASSIGN_OR_RETURN(const bench::StreamBenchmark stream,
                          bench::benchmark_stream(streams::camera_stream(camera, 1), options.height, options.width));
    const auto row = [](double ours, double reference) {
      return Json{{"mpx_per_s", ours}, {"reference_mpx_per_s", reference}, {"ratio", ours / reference}};
    };
    const Json json = {{"coded_intensities", row(result.intensities_mpx_per_s, result.reference_intensities_mpx_per_s)},
                       {"events", row(result.events_mpx_per_s, result.reference_events_mpx_per_s)},
                       {"light_field_to_events", row(result.simulate_mpx_per_s, result.reference_simulate_mpx_per_s)}};
    const Json event_by_event = {{"events", stream.events},
                                 {"events_per_s", stream.events_per_s},
                                 {"one_thread_events_per_s", stream.one_thread_events_per_s},
                                 {"reference_events_per_s", stream.reference_events_per_s}};
    if (verb.common().json) {
      Json all = json;
      all["event_by_event"] = event_by_event;
      std::printf("%s", json_text(all).c_str());
      return {};
    }
    std::printf("%-24s %12s %12s %8s\n", "simulation, M pixels/s", "e2lf", "reference", "ratio");
    for (const auto& [name, values] : json.items()) {
      std::printf("%-24s %12.1f %12.2f %8.1f\n", name.c_str(), values["mpx_per_s"].get<double>(),
                  values["reference_mpx_per_s"].get<double>(), values["ratio"].get<double>());
    }
    std::printf("\nevent by event, physical pixels, M events/s: %.2f (one thread %.2f, scalar reference %.2f)\n",
                stream.events_per_s * 1e-6, stream.one_thread_events_per_s * 1e-6,
                stream.reference_events_per_s * 1e-6);
    return {};
  });
}

int run_bench_train(const std::vector<std::string>& arguments) {
  Verb verb("bench train", "Measure training and the synthesis of its data against plain libtorch, in the same run.",
            "e2lf bench train --batch 8 --json");
  uint64_t batch = 4, steps = 5;
  verb.app().add_option("--batch", batch, "samples of 64x64x8x8 for each step")->check(whole_number(1));
  verb.app().add_option("--steps", steps, "measured for each loop; figures are medians")->check(whole_number(1));
  return verb.run(arguments, [&] {
    std::vector<std::string> call = {"bench", "--batch", std::to_string(batch), "--steps", std::to_string(steps)};
    if (verb.common().json) call.emplace_back("--json");
    return become_trainer(std::move(call), verb.common().threads);
  });
}

}  // namespace

int run_bench(const std::vector<std::string>& arguments) {
  return run_subverb("bench",
                     {{"camera", "what each imperfection of a camera costs, for each model", run_bench_camera},
                      {"decode", "RAW recordings, against the scalar reference", run_bench_decode},
                      {"reconstruct", "the network, against libtorch and the machine's peak", run_bench_reconstruct},
                      {"rig", "one cycle from light field to light field, each stage", run_bench_rig},
                      {"simulate", "the event simulation, against the scalar reference", run_bench_simulate},
                      {"video", "networks that make frames of events, against libtorch", run_bench_video},
                      {"train", "training steps and the synthesis of data, against plain libtorch", run_bench_train}},
                     arguments);
}

}  // namespace e2lf::cli
