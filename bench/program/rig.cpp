// SPDX-License-Identifier: MIT
// e2lf-bench rig: light field -> events -> RAW -> events -> event images -> light field
#include <chrono>
#include <cstdio>

#include "bench/program/parts.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/model/model.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/verb.h"
#include "e2lf/recon/fusion.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/streams/event_stream.h"
#include "e2lf/streams/virtual_rig.h"

namespace e2lf::bench {
using namespace program;
namespace {

using lightfield::LightField;

struct RigBench {
  size_t width = 1280, height = 720;
  std::string camera = "evk4-lcos", precision = "auto";
  std::filesystem::path model;
  float scene_gain = 1.0F;
};

/// Returns the demo scene rendered at a quarter of the size and enlarged, because rendering is not measured.
LightField enlarged_scene(size_t height, size_t width) {
  constexpr size_t kTimes = 4;
  const lightfield::Shape small_shape{8, 8, (height + kTimes - 1) / kTimes, (width + kTimes - 1) / kTimes, 1};
  const LightField small = lightfield::render_light_field(lightfield::demo_scene(1), small_shape, 2);
  LightField field({8, 8, height, width, 1});
  for (size_t view = 0; view < 64; ++view) {
    const auto from = small.view(view / 8, view % 8);
    const auto to = field.view(view / 8, view % 8);
    for (size_t i = 0; i < to.size(); ++i) {
      to[i] = from[i / width / kTimes * small_shape.width + i % width / kTimes];
    }
  }
  return field;
}

/// Measures the time of each stage, under its name, or that of one of its repetitions.
class Stages {
 public:
  void end(const std::string& name, int repetitions = 1) {
    const std::chrono::duration<double> elapsed = Clock::now() - last_;
    json_.push_back({{"stage", name}, {"seconds", elapsed.count() / repetitions}});
    last_ = Clock::now();
  }
  [[nodiscard]] const Json& json() const { return json_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
  Json json_ = Json::array();
};

Result<std::vector<uint8_t>> encode(const recordings::EventBatch& batch, const RigBench& options) {
  std::vector<uint8_t> bytes;
  recordings::RecordingInfo info;
  info.width = options.width;
  info.height = options.height;
  E2LF_ASSIGN_OR_RETURN(const auto writer,
                        recordings::create_recording(recordings::make_memory_sink(bytes), "evt3", info));
  E2LF_RETURN_IF_ERROR(writer->write(batch));
  E2LF_RETURN_IF_ERROR(writer->finish());
  return bytes;
}

Result<std::unique_ptr<recordings::RecordingReader>> open(const std::vector<uint8_t>& bytes) {
  recordings::OpenOptions options;
  options.threads = 0;
  return recordings::open_recording(recordings::make_memory_source(bytes), options);
}

Result<capture::EventImages> accumulate(const std::vector<uint8_t>& bytes, size_t num_patterns) {
  E2LF_ASSIGN_OR_RETURN(auto reader, open(bytes));
  cycles::CycleOptions options;
  options.source = cycles::CycleSource::kTriggers;
  options.schedule = cycles::paper_schedule(num_patterns);
  // A few thousand pixels have too few events to determine the half with which the cycle begins.
  options.tracker.first_pattern = 0;
  E2LF_ASSIGN_OR_RETURN(cycles::CycleReader cycles, cycles::CycleReader::open(std::move(reader), options));
  E2LF_ASSIGN_OR_RETURN(std::optional<cycles::Cycle> cycle, cycles.next());
  if (!cycle) return Error{ErrorCode::kNotFound, "the cycle was not found again; this is a bug", ""};
  return std::move(cycle->images);
}

Result<Json> measure(const RigBench& options, const capture::SensorProfile& camera, model::Model model) {
  const capture::Codes codes = *model.codes;
  E2LF_ASSIGN_OR_RETURN(const auto precision, choice_of(options.precision, engine::kPrecisions, "precision"));
  engine::EngineOptions engine;
  engine.precision = precision;
  E2LF_ASSIGN_OR_RETURN(const auto network, recon::Reconstructor::create(std::move(model), engine));
  streams::MovingScene scene;
  scene.at = [field = enlarged_scene(options.height, options.width)](uint64_t) { return Result<LightField>(field); };
  streams::RigOptions rig_options;
  rig_options.gain = options.scene_gain;
  rig_options.schedule = cycles::paper_schedule(codes.num_patterns);
  E2LF_ASSIGN_OR_RETURN(auto rig,
                        streams::VirtualRig::create(codes, camera, streams::camera_stream(camera, 1), rig_options,
                                                    std::move(scene), options.height, options.width));
  Stages stages;
  E2LF_ASSIGN_OR_RETURN(recordings::EventBatch batch, rig.play_cycle());
  stages.end("simulate");
  const capture::EventImages summed = rig.sum_windows(batch);
  // The first trigger of the next cycle marks the end of a cycle.
  E2LF_REQUIRE(!batch.triggers.empty(), "the rig gives a trigger for each pattern");
  const int64_t end_us = batch.triggers.front().t + rig_options.schedule.cycle_us();
  batch.triggers.push_back({end_us, batch.triggers.front().id, 1});
  stages.end("sum");
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, encode(batch, options));
  stages.end("encode");
  E2LF_ASSIGN_OR_RETURN(const auto reader, open(bytes));
  E2LF_ASSIGN_OR_RETURN(const recordings::EventBatch decoded, recordings::read_all(*reader));
  stages.end("decode");
  E2LF_ASSIGN_OR_RETURN(const capture::EventImages images, accumulate(bytes, codes.num_patterns));
  stages.end("decode and accumulate");
  constexpr int kFused = 64;
  recon::CycleFusion fusion(camera, kFused / 4);
  for (int cycle = 0; cycle < kFused; ++cycle) fusion.add(images);
  stages.end("fuse", kFused);
  E2LF_ASSIGN_OR_RETURN(const LightField field, network.reconstruct(images));
  stages.end("reconstruct");
  uint64_t in_images = 0;
  for (const int16_t count : images.values) in_images += static_cast<uint64_t>(std::abs(count));
  return Json{{"image", {options.height, options.width}},
              {"threads", num_threads()},
              {"events", batch.events.size()},
              {"events_in_images", in_images},
              {"raw_bytes", bytes.size()},
              {"decoded_is_simulated", decoded.events == batch.events},
              {"accumulated_is_summed", images == summed},
              {"views", field.shape().num_views()},
              {"stages", stages.json()}};
}

BenchReport rig_report(const Json& json) {
  report::Table table{"", {{"stage"}, {"seconds", true}}, {}};
  for (const Json& stage : json["stages"]) {
    table.rows.push_back(
        {report::text_cell(stage["stage"].get<std::string>()), report::number_cell(stage["seconds"].get<double>(), 4)});
  }
  char about[200];
  std::snprintf(about, sizeof about,
                "%dx%d px, %d threads, %lld events in a cycle, %lld in its event images, %.1f MB of RAW",
                json["image"][1].get<int>(), json["image"][0].get<int>(), json["threads"].get<int>(),
                json["events"].get<long long>(), json["events_in_images"].get<long long>(),
                json["raw_bytes"].get<double>() * 1e-6);
  return {"One cycle from light field to light field",
          about,
          {table},
          cat("decoded events equal the simulated ones: ", json["decoded_is_simulated"].dump(),
              "; so do their sums: ", json["accumulated_is_summed"].dump())};
}

}  // namespace

int run_rig(const std::vector<std::string>& arguments) {
  Verb verb("rig",
            "Simulate, encode, decode, accumulate and reconstruct one cycle, and measure the time of each stage.",
            "e2lf-bench rig -m e2lf-n4 --json");
  RigBench options;
  const CLI::Range pixels(size_t{16}, size_t{16384});
  verb.app().add_option("--width", options.width, "of the sensor in pixels")->check(pixels)->capture_default_str();
  verb.app().add_option("--height", options.height, "of the sensor in pixels")->check(pixels)->capture_default_str();
  add_model_option(verb.app(), "-m,--model", options.model,
                   "model file with patterns, or bundled model; default: e2lf-n4");
  verb.app()
      .add_option("--precision", options.precision, "arithmetic of the network")
      ->check(CLI::IsMember({"auto", "float32", "bfloat16", "int16"}))
      ->capture_default_str();
  verb.app().add_option("--scene-gain", options.scene_gain, "brightness of the scene")->capture_default_str();
  add_camera_option(verb.app(), options.camera, "the camera that records; default: evk4-lcos");
  const auto measure_all = [&]() -> Result<Json> {
    const auto path = options.model.empty() ? bundled_model() : options.model;
    if (!path) return Error{ErrorCode::kNotFound, "no model is bundled; give one with -m", ""};
    E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(*path));
    if (!model.codes)
      return Error{ErrorCode::kNotFound, "the model contains no patterns; use one that does", path->string()};
    RunRecord record(verb);
    E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, load_camera(options.camera, record));
    E2LF_ASSIGN_OR_RETURN(const Json json, measure(options, camera, std::move(model)));
    return json;
  };
  return run_bench(verb, arguments, measure_all, rig_report);
}

}  // namespace e2lf::bench
