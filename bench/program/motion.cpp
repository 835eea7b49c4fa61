// SPDX-License-Identifier: MIT
// e2lf-bench motion: reconstructs moving scenes from the lit transitions, from those of the whole cycle, and from fused
// cycles.
#include <algorithm>

#include "bench/program/fused_motion.h"
#include "bench/program/moving_scenes.h"
#include "bench/program/parts.h"
#include "bench/program/report.h"
#include "bench/program/verbs.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/program/light_fields.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"
#include "e2lf/program/verb.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/recon/scene_motion.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

namespace fs = std::filesystem;
using lightfield::LightField;

/// In the second cycle, the references are those that the first one left.
constexpr size_t kCycles = 2;

struct MotionBench {
  std::vector<fs::path> scenes;
  fs::path lit, whole;
  std::string camera = "evk4-lcos";
  size_t size = 160;
  uint64_t seed = 1;
};

/// One kind of motion, and the shots of all scenes with it.
struct Motion {
  std::string name;
  std::vector<Shot> shots;
};

Result<std::vector<Motion>> motions(const std::vector<LightField>& scenes, const MotionBench& options,
                                    int64_t cycle_us) {
  std::vector<Motion> result;
  for (const double px : {0.0, 0.5, 1.0, 2.0, 3.0, 6.0}) {
    Motion& motion = result.emplace_back(Motion{cat("scenes that move ", px, " px per cycle"), {}});
    for (const LightField& scene : scenes) {
      const auto moving = shift(scene, px, cycle_us, kCycles, options.size);
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), shot_of(moving, cycle_us, kCycles - 1));
    }
  }
  for (const double rpm : {0.0, 0.5, 1.75, 5.0, 10.0}) {
    Motion& motion = result.emplace_back(Motion{cat("turntable at ", rpm, " rpm"), {}});
    for (const uint64_t seed : {1U, 2U}) {
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), shot_of(turn(rpm, options.size, seed), cycle_us, kCycles - 1));
    }
  }
  return result;
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
      E2LF_ASSIGN_OR_RETURN(const auto cycles,
                            record_cycles(motion.shots[i], codes, camera, options.seed + i, kCycles));
      E2LF_ASSIGN_OR_RETURN(row["shots"].emplace_back(), measure_shot(motion.shots[i], cycles.back(), networks));
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
          {table, fused_motion_table(json["fused"])}};
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
  if (!codes || !capture::codes_of_whole_cycle(*codes) || lit.model().codes != capture::codes_of_whole_cycle(*codes) ||
      !model::is_conditioned_on_camera(lit.model())) {
    return Error{ErrorCode::kInvalidValue,
                 "the two networks are not for the lit transitions and the whole cycle of the same patterns, or the "
                 "first one is not conditioned on the camera; give others with --lit and --whole",
                 ""};
  }
  std::vector<LightField> scenes;
  for (const fs::path& path : options.scenes) {
    E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), load_scene(path, SceneOptions{}, true));
  }
  const cycles::Schedule schedule = cycles::paper_schedule_of(*codes);
  E2LF_ASSIGN_OR_RETURN(const std::vector<Motion> shown, motions(scenes, options, schedule.cycle_us()));
  const bool is_quiet = verb.common().quiet;
  E2LF_ASSIGN_OR_RETURN(Json fused, measure_fused_motion(scenes, *codes, lit, options.size, options.seed, is_quiet));
  E2LF_ASSIGN_OR_RETURN(Json json,
                        measure(shown, *codes, camera, {std::move(lit), std::move(whole)}, options, is_quiet));
  json["fused"] = std::move(fused);
  return finish(verb, json, motion_report(json, options), reports);
}

}  // namespace

int run_motion(const std::vector<std::string>& arguments) {
  Verb verb(
      "motion",
      "Compare the lit transitions with the whole cycle and with fused cycles while the scene moves, in PSNR after a "
      "fit of the brightness.",
      "e2lf-bench motion scene/");
  MotionBench options;
  std::vector<fs::path> report_names;
  CLI::App& app = verb.app();
  add_report_option(app, report_names);
  app.add_option("scenes,-i,--input", options.scenes, "light fields of any format e2lf reads")->required();
  add_model_option(app, "--lit", options.lit, "network of the lit transitions; default: e2lf-n4-camera");
  add_model_option(app, "--whole", options.whole, "network of the whole cycle; default: e2lf-n4-cycle-camera");
  app.add_option("--size", options.size, "height and width of the middle part that is used, px")
      ->check(whole_number(128))
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
