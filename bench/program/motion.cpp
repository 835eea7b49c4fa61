// SPDX-License-Identifier: MIT
// e2lf-bench motion: reconstructs moving scenes from the lit transitions and from those of the whole cycle.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/program/parts.h"
#include "bench/program/report.h"
#include "bench/program/verbs.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/program/light_fields.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"
#include "e2lf/program/verb.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/recon/scene_motion.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/streams/event_stream.h"
#include "e2lf/streams/virtual_rig.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

namespace fs = std::filesystem;
using lightfield::LightField;

constexpr int64_t kTurntableKnotUs = 10000;
constexpr size_t kTruthsPerCycle = 8;

struct MotionBench {
  std::vector<fs::path> scenes;
  fs::path lit, whole;
  std::string camera = "evk4-lcos";
  size_t size = 160;
  uint64_t seed = 1;
};

/// A scene in motion, and the views of it that the second cycle may show.
struct Shot {
  streams::MovingScene scene;
  std::vector<LightField> truths;
};

/// One kind of motion, and the shots of all scenes with it.
struct Motion {
  std::string name;
  std::vector<Shot> shots;
};

/// Returns the scene at a time, between two of its knots.
Result<LightField> scene_at(const streams::MovingScene& scene, double t_us) {
  if (scene.knot_us == 0) return scene.at(0);
  const double position = t_us / static_cast<double>(scene.knot_us), knot = std::floor(position);
  const auto weight = static_cast<float>(position - knot);
  E2LF_ASSIGN_OR_RETURN(LightField field, scene.at(static_cast<uint64_t>(knot)));
  E2LF_ASSIGN_OR_RETURN(const LightField next, scene.at(static_cast<uint64_t>(knot) + 1));
  for (size_t i = 0; i < field.data().size(); ++i) field.data()[i] += weight * (next.data()[i] - field.data()[i]);
  return field;
}

/// Returns the scene with its views at equal distances of time in the second cycle.
Result<Shot> shot_of(streams::MovingScene scene, int64_t cycle_us) {
  Shot shot{std::move(scene), {}};
  const size_t steps = shot.scene.knot_us > 0 ? kTruthsPerCycle : 0;
  for (size_t n = 0; n <= steps; ++n) {
    const double cycles = 1 + static_cast<double>(n) / kTruthsPerCycle;
    E2LF_ASSIGN_OR_RETURN(shot.truths.emplace_back(), scene_at(shot.scene, cycles * static_cast<double>(cycle_us)));
  }
  return shot;
}

/// Returns a scene that moves to the left by `px_per_cycle`.
streams::MovingScene shift(const LightField& scene, double px_per_cycle, int64_t cycle_us, size_t size) {
  streams::MovingScene moving;
  moving.at = [&scene, size](uint64_t knot) { return in_view(scene, size, std::min<size_t>(knot, kMostMotionPx)); };
  if (px_per_cycle > 0) moving.knot_us = std::lround(static_cast<double>(cycle_us) / px_per_cycle);
  return moving;
}

/// Returns the still life on the turntable.
streams::MovingScene turn(double rpm, size_t size, uint64_t seed) {
  const double radians = rpm / 60 * 2 * std::numbers::pi * kTurntableKnotUs * 1e-6;
  const auto at = [=](uint64_t knot) -> Result<LightField> {
    const auto angle = static_cast<float>(radians * static_cast<double>(knot));
    return lightfield::render_light_field(lightfield::turntable_scene(angle, seed), {8, 8, size, size, 1});
  };
  return {at, rpm > 0 ? kTurntableKnotUs : 0};
}

Result<std::vector<Motion>> motions(const std::vector<LightField>& scenes, const MotionBench& options,
                                    int64_t cycle_us) {
  std::vector<Motion> result;
  for (const double px : {0.0, 0.5, 1.0, 2.0, 3.0, 6.0}) {
    Motion& motion = result.emplace_back(Motion{cat("scenes that move ", px, " px per cycle"), {}});
    for (const LightField& scene : scenes) {
      const auto moving = shift(scene, px, cycle_us, options.size);
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), shot_of(moving, cycle_us));
    }
  }
  for (const double rpm : {0.0, 0.5, 1.75, 5.0, 10.0}) {
    Motion& motion = result.emplace_back(Motion{cat("turntable at ", rpm, " rpm"), {}});
    for (const uint64_t seed : {1U, 2U}) {
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), shot_of(turn(rpm, options.size, seed), cycle_us));
    }
  }
  return result;
}

/// Returns the event images of the whole second cycle, in which the references are those that the first cycle left.
Result<capture::EventImages> play(const Shot& shot, const capture::Codes& codes, const capture::SensorProfile& camera,
                                  uint64_t seed) {
  streams::RigOptions options;
  options.schedule = cycles::paper_schedule_of(codes);
  options.trigger_channel.reset();
  const lightfield::Shape& shape = shot.truths.front().shape();
  E2LF_ASSIGN_OR_RETURN(auto rig, streams::VirtualRig::create(codes, camera, streams::camera_stream(camera, seed),
                                                              options, shot.scene, shape.height, shape.width));
  E2LF_ASSIGN_OR_RETURN(recordings::EventBatch batch, rig.play_cycle());
  E2LF_ASSIGN_OR_RETURN(batch, rig.play_cycle());
  return rig.sum_windows(batch);
}

/// Returns the event images of the second cycle in an event model of the paper. Pattern n is shown at one moment, which
/// is the light that its events lead to.
Result<capture::EventImages> simulate(const Shot& shot, const capture::Codes& codes,
                                      const capture::SensorProfile& camera, uint64_t seed) {
  const size_t steps = codes.num_patterns - 1;
  const auto cycle_us = static_cast<double>(cycles::paper_schedule_of(codes).cycle_us());
  sensor::CodedIntensities shown;
  for (size_t n = 0; n <= steps; ++n) {
    const double t_us = cycle_us * (1 + static_cast<double>(n) / static_cast<double>(steps));
    E2LF_ASSIGN_OR_RETURN(const LightField scene, scene_at(shot.scene, t_us));
    E2LF_ASSIGN_OR_RETURN(const sensor::CodedIntensities all, sensor::coded_intensities(codes, scene));
    if (n == 0) shown.resize(all.count, all.height, all.width);
    std::copy(all.image(n).begin(), all.image(n).end(), shown.image(n).begin());
  }
  sensor::EventModelOptions options{.constants = camera.constants, .seed = seed};
  E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(camera.event_model));
  return sensor::simulate_events(shown, options);
}

struct Networks {
  recon::Reconstructor lit, whole;
};

Result<Json> measure_shot(const Shot& shot, const capture::EventImages& images, const Networks& networks) {
  Json json;
  const auto add = [&](const char* name, const recon::Reconstructor& network,
                       const capture::EventImages& given) -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const LightField field, network.reconstruct(given));
    E2LF_ASSIGN_OR_RETURN(json[name], best_psnr_db(field, shot.truths));
    return {};
  };
  E2LF_RETURN_IF_ERROR(add("lit_psnr_db", networks.lit, recon::lit_transitions(images)));
  E2LF_RETURN_IF_ERROR(add("whole_psnr_db", networks.whole, images));
  json["scene_motion"] = recon::scene_motion(images);
  return json;
}

Result<Json> measure(const std::vector<Motion>& motions, const capture::Codes& codes,
                     const capture::SensorProfile& camera, const Networks& networks, const MotionBench& options,
                     bool is_quiet) {
  ProgressBar bar("motion", is_quiet);
  Json rows = Json::array();
  for (const Motion& motion : motions) {
    Json row = {{"motion", motion.name}, {"shots", Json::array()}};
    for (size_t i = 0; i < motion.shots.size(); ++i) {
      const auto record = camera.is_pixel() ? play : simulate;
      E2LF_ASSIGN_OR_RETURN(const auto images, record(motion.shots[i], codes, camera, options.seed + i));
      E2LF_ASSIGN_OR_RETURN(row["shots"].emplace_back(), measure_shot(motion.shots[i], images, networks));
    }
    for (const char* name : {"lit_psnr_db", "whole_psnr_db", "scene_motion"}) {
      double sum = 0;
      for (const Json& shot : row["shots"]) sum += shot[name].get<double>();
      row[name] = sum / static_cast<double>(motion.shots.size());
    }
    rows.push_back(std::move(row));
    bar.update(rows.size(), motions.size());
  }
  hide_progress();
  return Json{{"camera", camera.name}, {"size", options.size}, {"motions", std::move(rows)}};
}

BenchReport motion_report(const Json& json, const MotionBench& options) {
  report::Table table{"Means over the scenes.",
                      {{"motion"},
                       {"lit transitions", true, true, "lit_psnr_db"},
                       {"whole cycle", true, true, "whole_psnr_db"},
                       {"difference", true},
                       {"scene motion", true}},
                      {}};
  for (const Json& row : json["motions"]) {
    const double lit_db = row["lit_psnr_db"].get<double>(), whole_db = row["whole_psnr_db"].get<double>();
    const std::string name = row["motion"].get<std::string>();
    table.rows.push_back({report::text_cell(name), report::number_cell(lit_db, 2), report::number_cell(whole_db, 2),
                          report::number_cell(whole_db - lit_db, 2),
                          report::number_cell(row["scene_motion"].get<double>(), 3)});
  }
  return {"What motion costs",
          cat("PSNR of ", options.lit.stem().string(), " and ", options.whole.stem().string(),
              " against the best match within the cycle, dB, and the motion that the events of the whole cycle show; "
              "camera ",
              json["camera"].get<std::string>()),
          {table}};
}

Result<recon::Reconstructor> open_network(const fs::path& path, const capture::SensorProfile& camera) {
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
  if (model::is_conditioned_on_camera(model)) model.camera = camera;
  return recon::Reconstructor::create(std::move(model));
}

Result<void> bench(const MotionBench& options, const std::vector<fs::path>& report_names, const Verb& verb) {
  std::vector<fs::path> inputs = options.scenes;
  inputs.insert(inputs.end(), {options.lit, options.whole});
  E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(report_names, output_rules(verb, inputs)));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, load_camera(options.camera, record));
  E2LF_ASSIGN_OR_RETURN(recon::Reconstructor lit, open_network(options.lit, camera));
  E2LF_ASSIGN_OR_RETURN(recon::Reconstructor whole, open_network(options.whole, camera));
  const std::optional<capture::Codes> codes = whole.model().codes;
  if (!codes || !capture::codes_of_whole_cycle(*codes) || lit.model().codes != capture::codes_of_whole_cycle(*codes)) {
    return Error{ErrorCode::kInvalidValue,
                 "the two networks are not for the lit transitions and the whole cycle of the same patterns; give "
                 "others with --lit and --whole",
                 ""};
  }
  std::vector<LightField> scenes;
  for (const fs::path& path : options.scenes) {
    E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), load_scene(path, SceneOptions{}, true));
  }
  const cycles::Schedule schedule = cycles::paper_schedule_of(*codes);
  E2LF_ASSIGN_OR_RETURN(const std::vector<Motion> shown, motions(scenes, options, schedule.cycle_us()));
  E2LF_ASSIGN_OR_RETURN(const Json json, measure(shown, *codes, camera, {std::move(lit), std::move(whole)}, options,
                                                 verb.common().quiet));
  return finish(verb, json, motion_report(json, options), reports);
}

}  // namespace

int run_motion(const std::vector<std::string>& arguments) {
  Verb verb("motion",
            "Compare the whole cycle with the lit transitions while the scene moves, in PSNR after a fit of the "
            "brightness.",
            "e2lf-bench motion scene/");
  MotionBench options;
  std::vector<fs::path> report_names;
  CLI::App& app = verb.app();
  add_report_option(app, report_names);
  app.add_option("scenes,-i,--input", options.scenes, "light fields of any format e2lf reads")->required();
  add_model_option(app, "--lit", options.lit, "network of the lit transitions; default: e2lf-n4-camera");
  add_model_option(app, "--whole", options.whole, "network of the whole cycle; default: e2lf-n4-cycle-camera");
  app.add_option("--size", options.size, "height and width of the middle part that is used, px")
      ->check(whole_number(32))
      ->capture_default_str();
  add_camera_option(app, options.camera, "the camera; default: evk4-lcos");
  return verb.run(arguments, [&]() -> Result<void> {
    const auto use_bundled = [](fs::path& path, const char* file) {
      if (path.empty()) path = bundled_file(file).value_or(file);
    };
    use_bundled(options.lit, "models/e2lf-n4-camera.safetensors");
    use_bundled(options.whole, "models/e2lf-n4-cycle-camera.safetensors");
    return bench(options, report_names, verb);
  });
}

}  // namespace e2lf::bench
