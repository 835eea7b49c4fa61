// SPDX-License-Identifier: MIT
// e2lf-bench: measures speed against the peers in the same run.
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>

#include "bench/program/reconstruct.h"
#include "bench/program/report.h"
#include "bench/program/verbs.h"
#include "bench/program/video.h"
#include "bench/simulate/benchmark_simulate.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/files/options.h"
#include "e2lf/formats/formats.h"
#include "e2lf/model/model.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"
#include "e2lf/program/verb.h"
#include "e2lf/streams/event_stream.h"
#include "e2lf/terminal/progress_bar.h"
#include "e2lf/video/operations.h"

namespace e2lf::bench {
using namespace program;
namespace {

/// A number that may not be there.
report::Cell number_of(const Json& row, const char* name, int decimals, double factor = 1) {
  if (!row.contains(name)) return {};
  const Json& value = row[name].is_object() ? row[name]["median"] : row[name];
  return report::number_cell(factor * value.get<double>(), decimals);
}

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

void add_size_options(Verb& verb, size_t& width, size_t& height) {
  const CLI::Range pixels(size_t{1}, size_t{16384});
  verb.app().add_option("--width", width, "of the image in pixels")->check(pixels)->capture_default_str();
  verb.app().add_option("--height", height, "of the image in pixels")->check(pixels)->capture_default_str();
}

int run_reconstruct(const std::vector<std::string>& arguments) {
  Verb verb("reconstruct",
            "Measure the reconstruction network against oneDNN, libtorch and the machine's multiply-add peak, in the "
            "same run.",
            "e2lf-bench reconstruct --json");
  ReconstructBench options;
  std::filesystem::path model;
  std::vector<std::filesystem::path> report_names;
  add_size_options(verb, options.width, options.height);
  verb.app()
      .add_option("--runs", options.runs, "of each; figures are medians")
      ->check(whole_number(1))
      ->capture_default_str();
  add_model_option(verb.app(), "-m,--model", model,
                   "model file or bundled model; default: the paper's network with random weights");
  verb.app().add_option("--onnx", options.onnx_packages,
                        "measure ONNX Runtime, too: a folder in which npm has installed onnxruntime-node");
  add_report_option(verb.app(), report_names);
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, open_reports(report_names, verb));
    if (!model.empty()) {
      E2LF_ASSIGN_OR_RETURN(options.model, model::read_model(model));
    }
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const Json json, bench_reconstruct(options, bar.callback()));
    hide_progress();
    return finish(verb, json, reconstruct_report(json), reports);
  });
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

int run_video(const std::vector<std::string>& arguments) {
  Verb verb("video", "Measure networks that make frames of events against libtorch, in the same run.",
            "e2lf-bench video --json");
  VideoBench options;
  std::filesystem::path model;
  std::vector<std::filesystem::path> report_names;
  add_size_options(verb, options.width, options.height);
  verb.app()
      .add_option("--frames", options.frames, "of each; figures are medians")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  verb.app().add_option("-m,--model", model,
                        "model file; default: FireNet, E2VID's network and ET-Net with random weights");
  add_report_option(verb.app(), report_names);
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, open_reports(report_names, verb));
    if (!model.empty()) {
      E2LF_ASSIGN_OR_RETURN(options.model, video::read_video_model(model));
    }
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const Json json, bench_video(options, bar.callback()));
    hide_progress();
    return finish(verb, json, video_report(json), reports);
  });
}

BenchReport simulation_report(const Json& json, const StreamBenchmark& stream) {
  report::Table table{"Millions of pixels per second; the reference runs on one thread.",
                      {{"simulation, M pixels/s"}, {"e2lf", true}, {"reference", true}, {"ratio", true}},
                      {}};
  for (const auto& [name, values] : json.items()) {
    if (!values.contains("mpx_per_s")) continue;
    table.rows.push_back({report::text_cell(name), number_of(values, "mpx_per_s", 1),
                          number_of(values, "reference_mpx_per_s", 2), number_of(values, "ratio", 1)});
  }
  report::Table by_event{
      "Event by event, physical pixels.",
      {{"event by event, M events/s"}, {"all threads", true}, {"one thread", true}, {"reference", true}},
      {}};
  by_event.rows.push_back({report::text_cell("physical pixels"), report::number_cell(stream.events_per_s * 1e-6, 2),
                           report::number_cell(stream.one_thread_events_per_s * 1e-6, 2),
                           report::number_cell(stream.reference_events_per_s * 1e-6, 2)});
  return {"Speed of simulation",
          cat(num_threads(), " threads, ", current_isa(), "; the scalar reference in the same run"),
          {table, by_event}};
}

int run_simulate(const std::vector<std::string>& arguments) {
  Verb verb("simulate", "Measure the event simulation against the scalar reference on one thread, in the same run.",
            "e2lf-bench simulate --json");
  SimulationBenchmarkOptions options;
  std::vector<std::filesystem::path> report_names;
  add_size_options(verb, options.width, options.height);
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  add_report_option(verb.app(), report_names);
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, open_reports(report_names, verb));
    E2LF_ASSIGN_OR_RETURN(const SimulationBenchmark result, benchmark_simulation(options));
    RunRecord record(verb);
    E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, load_camera("evk4-lcos", record));
    E2LF_ASSIGN_OR_RETURN(const StreamBenchmark stream,
                          benchmark_stream(streams::camera_stream(camera, 1), options.height, options.width));
    const auto row = [](double ours, double reference) {
      return Json{{"mpx_per_s", ours}, {"reference_mpx_per_s", reference}, {"ratio", ours / reference}};
    };
    const Json json = {{"coded_intensities", row(result.intensities_mpx_per_s, result.reference_intensities_mpx_per_s)},
                       {"events", row(result.events_mpx_per_s, result.reference_events_mpx_per_s)},
                       {"light_field_to_events", row(result.simulate_mpx_per_s, result.reference_simulate_mpx_per_s)},
                       {"event_by_event",
                        {{"events", stream.events},
                         {"events_per_s", stream.events_per_s},
                         {"one_thread_events_per_s", stream.one_thread_events_per_s},
                         {"reference_events_per_s", stream.reference_events_per_s}}}};
    return finish(verb, json, simulation_report(json, stream), reports);
  });
}

report::Cell text_of(const Json& row, const char* name) {
  return report::text_cell(row[name].get<std::string>());
}

BenchReport training_report(const Json& json) {
  report::Table table{"Ratios to the first row of the same job.",
                      {{"job"}, {"what"}, {"precision"}, {"samples/s", true}, {"ratio", true}},
                      {}};
  for (const Json& row : json["rows"]) {
    table.rows.push_back({text_of(row, "job"), text_of(row, "name"), text_of(row, "precision"),
                          number_of(row, "samples_per_s", 2), number_of(row, "ratio", 2)});
  }
  return {"Speed of training",
          cat("training: samples of 64x64x8x8, batch ", json["batch"].get<uint64_t>(),
              "; synthesis: light fields of 96x96x8x8; ", json["threads"].get<int>(), " threads"),
          {std::move(table)}};
}

/// Runs the program that measures training, which needs torch, and reads the JSON that it prints.
Result<Json> run_training_program(const std::vector<std::string>& arguments, int threads) {
  std::error_code status;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", status);
  const std::string program = (self.parent_path() / "e2lf-bench-train").string();
  if (!std::filesystem::exists(program, status)) {
    return Error{ErrorCode::kMissingDependency,
                 "the program was not built; `./run bench train` builds it with libtorch", program};
  }
  if (threads > 0) ::setenv("OMP_NUM_THREADS", std::to_string(threads).c_str(), 1);
  std::string command = program::shell_word(program);
  for (const std::string& argument : arguments) command += cat(" ", program::shell_word(argument));
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr)
    return Error{ErrorCode::kIo, cat("cannot start the program (", std::strerror(errno), ")"), program};
  std::string text;
  for (int letter; (letter = std::fgetc(pipe)) != EOF;) text += static_cast<char>(letter);
  if (::pclose(pipe) != 0) return Error{ErrorCode::kInternal, "the program failed; see its message above", program};
  return parse_json(text, program);
}

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train", "Measure training and the synthesis of its data against plain libtorch, in the same run.",
            "e2lf-bench train --batch 8 --json");
  uint64_t batch = 4, steps = 5;
  std::vector<std::filesystem::path> report_names;
  add_report_option(verb.app(), report_names);
  verb.app().add_option("--batch", batch, "samples of 64x64x8x8 for each step")->check(whole_number(1));
  verb.app().add_option("--steps", steps, "measured for each loop; figures are medians")->check(whole_number(1));
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, open_reports(report_names, verb));
    E2LF_ASSIGN_OR_RETURN(const Json json,
                          run_training_program({std::to_string(batch), std::to_string(steps)}, verb.common().threads));
    return finish(verb, json, training_report(json), reports);
  });
}

int run(const std::vector<std::string>& arguments) {
  return run_subverb("",
                     {{"camera", "what each imperfection of a camera costs, for each model", run_camera},
                      {"decode", "RAW recordings, against the scalar reference", run_decode},
                      {"depth", "disparity maps, against true ones", run_depth},
                      {"motion", "what the whole cycle gains or loses if the scene moves", run_motion},
                      {"reconstruct", "the network, against oneDNN, libtorch and the machine's peak", run_reconstruct},
                      {"rig", "one cycle from light field to light field, each stage", run_rig},
                      {"simulate", "the event simulation, against the scalar reference", run_simulate},
                      {"video", "networks that make frames of events, against libtorch", run_video},
                      {"train", "training steps and the synthesis of data, against plain libtorch", run_train}},
                     arguments);
}

}  // namespace
}  // namespace e2lf::bench

int main(int argc, char** argv) {
  e2lf::formats::add_formats();
  e2lf::cameras::add_cameras();
  e2lf::video::add_operations();  // any model may have them
  return e2lf::program::run_program("e2lf-bench", argc, argv, e2lf::bench::run);
}
