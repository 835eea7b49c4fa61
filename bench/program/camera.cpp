// SPDX-License-Identifier: MIT
// e2lf-bench camera: reconstructs scenes recorded by a camera with one imperfection added or removed, with each model
#include <algorithm>

#include "bench/program/parts.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/verb.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/streams/event_stream.h"
#include "e2lf/streams/virtual_rig.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

namespace fs = std::filesystem;
using capture::SensorProfile;
using lightfield::LightField;
using enum capture::PixelConstant;

constexpr double kEvk4Pixels = 1280.0 * 720.0;

struct CameraBench {
  std::vector<fs::path> scenes, models;
  fs::path codes;
  std::string camera = "evk4-lcos", precision = "auto";
  size_t size = 256;
  float scene_gain = 1.0F;
};

/// A camera with one property changed, to measure the influence of this property.
struct CameraSetting {
  std::string name;
  capture::SensorProfile camera;       ///< the sensor profile that the network receives
  streams::PixelDefects defects = {};  ///< defects that are unknown to the network
  double readout_events_per_s = 0;     ///< for a sensor of 1280x720 pixels; 0 = no limit
  int64_t rise_us = 0;                 ///< rise time of the display
  size_t motion_px = 0;                ///< motion of the scene to the left per cycle
};

constexpr float kAtOnceHz = 1e9F;
constexpr double kEvk4EventsPerS = 1.066e9;

void make_fast(SensorProfile& camera) {
  camera.pixel[kReceptorRate] = camera.pixel[kAmplifierRate] = kAtOnceHz;
}

void make_equal(SensorProfile& camera) {
  camera.pixel[kMismatch] = camera.pixel[kMismatchEach] = 0.0F;
}

void make_silent(SensorProfile& camera) {
  camera = without_noise(std::move(camera));
}

void make_even(SensorProfile& camera) {
  camera.transmission.clear();
  camera.transmission_slope_x.clear();
  camera.transmission_slope_y.clear();
  camera.pixel[kLeak] = 0.0F;
}

/// Returns the camera itself, the camera without one of its imperfections or with an additional one, and an ideal
/// camera. The event model of `camera` must be "pixel".
std::vector<CameraSetting> camera_settings(const SensorProfile& camera) {
  E2LF_REQUIRE(camera.is_pixel(), "the camera has physical pixels");
  std::vector<CameraSetting> settings;
  const auto add = [&](std::string name, const auto& change) {
    CameraSetting& setting = settings.emplace_back(CameraSetting{.name = std::move(name), .camera = camera});
    change(setting);
  };
  add("the camera", [](CameraSetting&) {});
  add("without a lag of its pixels", [](CameraSetting& s) { make_fast(s.camera); });
  add("without mismatch of thresholds", [](CameraSetting& s) { make_equal(s.camera); });
  add("without noise", [](CameraSetting& s) { make_silent(s.camera); });
  add("with an even aperture that closes fully", [](CameraSetting& s) { make_even(s.camera); });
  add("without any of these", [](CameraSetting& s) {
    make_fast(s.camera);
    make_equal(s.camera);
    make_silent(s.camera);
    make_even(s.camera);
  });
  for (const int us : {100, 300, 1000}) {
    add(cat("with a refractory period of ", us, " us"), [&](CameraSetting& s) { s.defects.refractory_us = us; });
  }
  for (const int hz : {1, 5}) {
    add(cat("with ", hz, " leak events per s and pixel"), [&](CameraSetting& s) { s.defects.leak_rate_hz = hz; });
  }
  add("with 0.1 % hot pixels", [](CameraSetting& s) { s.defects.hot_share = 0.001; });
  for (const int part : {1, 4, 16}) {
    add(cat("read out at ", part == 1 ? "" : "1/", part == 1 ? "" : std::to_string(part), part == 1 ? "" : " of ",
            "1.066 G events/s"),
        [&](CameraSetting& s) { s.readout_events_per_s = kEvk4EventsPerS / part; });
  }
  for (const int ms : {1, 3}) {
    add(cat("with a rise of the display over ", ms, " ms"), [&](CameraSetting& s) { s.rise_us = 1000 * ms; });
  }
  for (const size_t px : {1, 2, 4, 8}) {
    add(cat("of a scene that moves ", px, " px in a cycle"), [&](CameraSetting& s) { s.motion_px = px; });
  }
  return settings;
}

/// Returns the event images of the second cycle, in which the references are those that the first cycle left.
Result<capture::EventImages> play(const CameraSetting& setting, const capture::Codes& codes, const LightField& scene,
                                  const CameraBench& options, uint64_t seed) {
  E2LF_ASSIGN_OR_RETURN(const LightField first, in_view(scene, options.size, 0));
  streams::RigOptions rig_options;
  rig_options.schedule = cycles::paper_schedule_of(codes);
  rig_options.gain = options.scene_gain;
  rig_options.rise_us = setting.rise_us;
  rig_options.trigger_channel.reset();
  streams::MovingScene moving;
  moving.at = [&](uint64_t knot) { return in_view(scene, options.size, std::min<size_t>(knot, kMostMotionPx)); };
  if (setting.motion_px > 0) {
    moving.knot_us = rig_options.schedule.cycle_us() / static_cast<int64_t>(setting.motion_px);
  }
  streams::StreamOptions stream = streams::camera_stream(setting.camera, seed);
  stream.defects = setting.defects;
  stream.readout.events_per_s =
      setting.readout_events_per_s * static_cast<double>(first.shape().height * first.shape().width) / kEvk4Pixels;
  E2LF_ASSIGN_OR_RETURN(auto rig,
                        streams::VirtualRig::create(codes, setting.camera, stream, rig_options, std::move(moving),
                                                    first.shape().height, first.shape().width));
  E2LF_ASSIGN_OR_RETURN(recordings::EventBatch batch, rig.play_cycle());
  E2LF_ASSIGN_OR_RETURN(batch, rig.play_cycle());
  return rig.sum_windows(batch);
}

/// Returns the scene at each place that it has in the second cycle.
Result<std::vector<LightField>> places_of(const LightField& scene, const CameraBench& options, size_t motion_px) {
  std::vector<LightField> places;
  for (size_t px = motion_px; px <= 2 * motion_px; ++px) {
    E2LF_ASSIGN_OR_RETURN(places.emplace_back(), in_view(scene, options.size, px));
  }
  return places;
}

/// Returns the network, conditioned on the camera if it accepts one.
Result<recon::Reconstructor> reconstructor_for(model::Model model, const CameraSetting& setting,
                                               const CameraBench& options) {
  if (model::is_conditioned_on_camera(model)) model.camera = setting.camera;
  E2LF_ASSIGN_OR_RETURN(const auto precision, choice_of(options.precision, engine::kPrecisions, "precision"));
  return recon::Reconstructor::create(std::move(model), {.precision = precision});
}

struct NamedModel {
  model::Model model;
  capture::Codes codes;
};

Result<std::vector<NamedModel>> read_models(const CameraBench& options, RunRecord& record) {
  std::vector<NamedModel> models;
  for (const fs::path& path : options.models) {
    E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
    const CodesSource source{model.codes && options.codes.empty() ? path : fs::path(), options.codes};
    E2LF_ASSIGN_OR_RETURN(pipeline::KnownCodes known, load_codes(source, record));
    if (!model.codes && options.codes.empty()) {
      return Error{ErrorCode::kNotFound, "the model contains no patterns; give those of its camera with --codes",
                   path.string()};
    }
    models.push_back({std::move(model), std::move(known.codes)});
  }
  return models;
}

Result<std::vector<LightField>> read_scenes(const CameraBench& options) {
  std::vector<LightField> scenes;
  for (const fs::path& path : options.scenes) {
    E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), load_scene(path, SceneOptions{}, true));
  }
  return scenes;
}

/// Measures the PSNR for every setting, model and scene.
Result<Json> measure(const CameraBench& options, const capture::SensorProfile& camera,
                     const std::vector<NamedModel>& models, const std::vector<LightField>& scenes, bool is_quiet) {
  const std::vector<CameraSetting> settings = camera_settings(camera);
  ProgressBar bar("camera", is_quiet);
  size_t done = 0;
  Json rows = Json::array();
  for (const CameraSetting& setting : settings) {
    Json row = {{"setting", setting.name}, {"models", Json::array()}};
    for (const NamedModel& named : models) {
      E2LF_ASSIGN_OR_RETURN(const auto network, reconstructor_for(named.model, setting, options));
      Json psnr_db = Json::array();
      double sum_db = 0;
      for (size_t i = 0; i < scenes.size(); ++i) {
        E2LF_ASSIGN_OR_RETURN(const auto images, play(setting, named.codes, scenes[i], options, i + 1));
        E2LF_ASSIGN_OR_RETURN(const LightField field, network.reconstruct(images));
        E2LF_ASSIGN_OR_RETURN(const auto places, places_of(scenes[i], options, setting.motion_px));
        E2LF_ASSIGN_OR_RETURN(const double db, best_psnr_db(field, places));
        psnr_db.push_back(db);
        sum_db += db;
        bar.update(++done, settings.size() * models.size() * scenes.size());
      }
      row["models"].push_back({{"model", named.model.name},
                               {"psnr_db", std::move(psnr_db)},
                               {"mean_psnr_db", sum_db / static_cast<double>(scenes.size())}});
    }
    rows.push_back(std::move(row));
  }
  hide_progress();
  return Json{{"camera", camera.name}, {"size", options.size}, {"scenes", scenes.size()}, {"settings", rows}};
}

BenchReport camera_report(const Json& json) {
  report::Table table{"Differences are to the camera itself, the first line.", {{"setting"}}, {}};
  const Json& base = json["settings"][0]["models"];
  for (const Json& model : base) {
    const std::string name = model["model"].get<std::string>();
    table.columns.push_back({name, true, true, cat(name, " psnr_db")});
    table.columns.push_back({"difference", true, false, cat(name, " difference_db")});
  }
  for (const Json& row : json["settings"]) {
    table.rows.push_back({report::text_cell(row["setting"].get<std::string>())});
    for (size_t i = 0; i < base.size(); ++i) {
      const double db = row["models"][i]["mean_psnr_db"].get<double>();
      table.rows.back().push_back(report::number_cell(db, 2));
      table.rows.back().push_back(report::number_cell(db - base[i]["mean_psnr_db"].get<double>(), 2));
    }
  }
  return {"What each imperfection of a camera costs",
          cat("mean PSNR over ", json["scenes"].get<size_t>(),
              " scenes at their best brightness, dB, and the difference to the camera (",
              json["camera"].get<std::string>(), ") itself"),
          {table}};
}

Result<Json> bench(const CameraBench& options, const Verb& verb) {
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, load_camera(options.camera, record));
  if (!camera.is_pixel()) {
    return Error{ErrorCode::kInvalidValue,
                 "a camera of the paper's event model has none of these imperfections; choose another",
                 "--camera " + options.camera};
  }
  E2LF_ASSIGN_OR_RETURN(const auto models, read_models(options, record));
  E2LF_ASSIGN_OR_RETURN(const auto scenes, read_scenes(options));
  return measure(options, camera, models, scenes, verb.common().quiet);
}

}  // namespace

int run_camera(const std::vector<std::string>& arguments) {
  Verb verb("camera",
            "Measure the cost of each imperfection of a camera in PSNR for each model, after a fit of the brightness.",
            "e2lf-bench camera scene/ -m e2lf-n4");
  CameraBench options;
  CLI::App& app = verb.app();
  app.add_option("scenes,-i,--input", options.scenes, "light fields of any format e2lf reads")->required();
  add_model_option(app, "-m,--model", options.models, "model files or bundled models; default: e2lf-n4");
  add_codes_option(app, options.codes, "patterns for models that contain none");
  app.add_option("--size", options.size, "height and width of the middle part that is used, px")
      ->check(whole_number(16))
      ->capture_default_str();
  app.add_option("--scene-gain", options.scene_gain, "brightness of the scenes")->capture_default_str();
  app.add_option("--precision", options.precision, "arithmetic of the network")
      ->check(CLI::IsMember({"auto", "float32", "bfloat16", "int16"}))
      ->capture_default_str();
  add_camera_option(app, options.camera, "the camera; default: evk4-lcos");
  const auto measure_all = [&]() -> Result<Json> {
    if (options.models.empty()) {
      const auto path = bundled_model();
      if (!path) return Error{ErrorCode::kNotFound, "no model is bundled; give one with -m", ""};
      options.models.push_back(*path);
    }
    return bench(options, verb);
  };
  return run_bench(verb, arguments, measure_all, camera_report, [&] {
    std::vector<fs::path> inputs = options.scenes;
    inputs.insert(inputs.end(), options.models.begin(), options.models.end());
    return inputs;
  });
}

}  // namespace e2lf::bench
