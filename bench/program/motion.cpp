// SPDX-License-Identifier: MIT
// e2lf-bench motion: reconstructs moving scenes from the lit transitions and from those of the whole cycle.
#include "bench/program/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/program/moving_scene.h"
#include "bench/program/report.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/cli/flags/option_values.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/turntable_scene.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/recon/scene_motion.h"
#include "e2lf/streams/stream_options.h"
#include "e2lf/streams/virtual_rig.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace cli;
namespace {

namespace fs = std::filesystem;
using lightfield::LightField;

constexpr int64_t kTurntableKnotUs = 10000;

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

/// Returns a scene that moves to the left by `px_per_cycle`.
Result<Shot> shift(const LightField& scene, double px_per_cycle, int64_t cycle_us, size_t size) {
  Shot shot;
  shot.scene.at = [&scene, size](uint64_t knot) { return in_view(scene, size, std::min<size_t>(knot, kMostMotionPx)); };
  if (px_per_cycle > 0) shot.scene.knot_us = std::lround(static_cast<double>(cycle_us) / px_per_cycle);
  for (auto px = static_cast<size_t>(px_per_cycle); px <= std::ceil(2 * px_per_cycle); ++px) {
    E2LF_ASSIGN_OR_RETURN(shot.truths.emplace_back(), in_view(scene, size, px));
  }
  return shot;
}

/// Returns the still life on the turntable.
Shot turn(double rpm, int64_t cycle_us, size_t size, uint64_t seed) {
  const double radians = rpm / 60 * 2 * std::numbers::pi * kTurntableKnotUs * 1e-6;
  const auto at = [=](uint64_t knot) {
    const auto angle = static_cast<float>(radians * static_cast<double>(knot));
    return lightfield::render_light_field(lightfield::turntable_scene(angle, seed), {8, 8, size, size, 1});
  };
  Shot shot;
  shot.scene.at = [at](uint64_t knot) -> Result<LightField> { return at(knot); };
  const auto knots = static_cast<uint64_t>(cycle_us / kTurntableKnotUs);
  if (rpm > 0) shot.scene.knot_us = kTurntableKnotUs;
  for (uint64_t knot = knots; knot <= (rpm > 0 ? 2 * knots + 1 : knots); knot += 2) shot.truths.push_back(at(knot));
  return shot;
}

Result<std::vector<Motion>> motions(const std::vector<LightField>& scenes, const MotionBench& options,
                                    int64_t cycle_us) {
  std::vector<Motion> result;
  for (const double px : {0.0, 0.5, 1.0, 2.0, 3.0, 6.0}) {
    Motion& motion = result.emplace_back(Motion{cat("scenes that move ", px, " px per cycle"), {}});
    for (const LightField& scene : scenes) {
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), shift(scene, px, cycle_us, options.size));
    }
  }
  for (const double rpm : {0.0, 0.5, 1.75, 5.0, 10.0}) {
    Motion& motion = result.emplace_back(Motion{cat("turntable at ", rpm, " rpm"), {}});
    for (const uint64_t seed : {1U, 2U}) motion.shots.push_back(turn(rpm, cycle_us, options.size, seed));
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
      E2LF_ASSIGN_OR_RETURN(const auto images, play(motion.shots[i], codes, camera, options.seed + i));
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
  report::BarChart chart{"mean PSNR, dB", false, 2, {}, {{"lit transitions", {}}, {"whole cycle", {}}}};
  for (const Json& row : json["motions"]) {
    const double lit_db = row["lit_psnr_db"].get<double>(), whole_db = row["whole_psnr_db"].get<double>();
    const std::string name = row["motion"].get<std::string>();
    table.rows.push_back({report::text_cell(name), report::number_cell(lit_db, 2), report::number_cell(whole_db, 2),
                          report::number_cell(whole_db - lit_db, 2),
                          report::number_cell(row["scene_motion"].get<double>(), 3)});
    chart.groups.push_back(name);
    chart.series[0].values.emplace_back(lit_db);
    chart.series[1].values.emplace_back(whole_db);
  }
  return {"What motion costs",
          cat("PSNR of ", options.lit.stem().string(), " and ", options.whole.stem().string(),
              " against the best match within the cycle, dB, and the motion that the events of the whole cycle show; "
              "camera ",
              json["camera"].get<std::string>()),
          {table},
          {chart}};
}

Result<recon::Reconstructor> open_network(const fs::path& path, const capture::SensorProfile& camera) {
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
  if (model::is_told_the_camera(model)) model.camera = camera;
  return recon::Reconstructor::create(std::move(model));
}

Result<void> bench(const MotionBench& options, const std::vector<fs::path>& report_names, const Verb& verb) {
  std::vector<fs::path> inputs = options.scenes;
  inputs.insert(inputs.end(), {options.lit, options.whole});
  E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(report_names, {.inputs = std::move(inputs),
                                                                                .overwrite = verb.common().overwrite}));
  RunRecord record("motion");
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
