// SPDX-License-Identifier: MIT
// e2lf-bench motion: reconstructs moving scenes from the lit transitions, from those of the whole cycle, and from fused
// cycles.
#include <algorithm>
#include <array>
#include <cmath>

#include "bench/program/moving_scenes.h"
#include "bench/program/parts.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/verb.h"
#include "e2lf/recon/fusion.h"
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

// Fused cycles.
constexpr size_t kFused = 8;      ///< their number; another one before them prepares the references
constexpr size_t kBorderPx = 12;  ///< that is not judged
constexpr std::array kInputs = {"one_psnr_db", "fused_psnr_db", "mean_psnr_db"};
constexpr std::array kParts = {"all", "still", "moving"};

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

/// Scenes, and the turntable, that move in the last of `cycles` cycles.
class Motions {
 public:
  Motions(const std::vector<LightField>& scenes, const MotionBench& options, int64_t cycle_us, size_t cycles)
      : scenes_(scenes), options_(options), cycle_us_(cycle_us), cycles_(cycles) {}

  Result<void> add_shift(double px) {
    Motion& motion = all_.emplace_back(Motion{cat("scenes that move ", px, " px per cycle"), {}});
    for (const LightField& scene : scenes_) {
      const auto moving = shift(scene, px, cycle_us_, cycles_, options_.size);
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), shot_of(moving, cycle_us_, cycles_ - 1));
    }
    return {};
  }

  Result<void> add_squares(size_t px) {
    Motion& motion = all_.emplace_back(Motion{cat("squares that move ", px, " px per cycle"), {}});
    for (size_t i = 0; i < scenes_.size(); ++i) {
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(), square_before(scenes_[i], scenes_[(i + 1) % scenes_.size()],
                                                                       px, cycle_us_, cycles_, options_.size));
    }
    return {};
  }

  Result<void> add_turntable(double rpm) {
    Motion& motion = all_.emplace_back(Motion{cat("turntable at ", rpm, " rpm"), {}});
    for (const uint64_t seed : {1U, 2U}) {
      E2LF_ASSIGN_OR_RETURN(motion.shots.emplace_back(),
                            shot_of(turn(rpm, options_.size, seed), cycle_us_, cycles_ - 1));
    }
    return {};
  }

  [[nodiscard]] const std::vector<Motion>& all() const { return all_; }

 private:
  const std::vector<LightField>& scenes_;
  const MotionBench& options_;
  int64_t cycle_us_;
  size_t cycles_;
  std::vector<Motion> all_;
};

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

Result<Json> measure(Motions motions, const capture::Codes& codes, const capture::SensorProfile& camera,
                     const Networks& networks, const MotionBench& options, bool is_quiet) {
  for (const double px : {0.0, 0.5, 1.0, 2.0, 3.0, 6.0}) E2LF_RETURN_IF_ERROR(motions.add_shift(px));
  for (const double rpm : {0.0, 0.5, 1.75, 5.0, 10.0}) E2LF_RETURN_IF_ERROR(motions.add_turntable(rpm));
  ProgressBar bar("motion", is_quiet);
  Json rows = Json::array();
  for (const Motion& motion : motions.all()) {
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
    bar.update(rows.size(), motions.all().size());
  }
  hide_progress();
  return rows;
}

/// Reconstructs the light fields of kInputs.
Result<std::array<LightField, kInputs.size()>> reconstruct_each(const std::vector<capture::EventImages>& cycles,
                                                                const recon::Reconstructor& network) {
  const size_t first = cycles.size() - kFused;
  recon::CycleFusion fusion(*network.model().camera, kFused);
  capture::EventImages sum, last;
  for (size_t i = first; i < cycles.size(); ++i) {
    last = recon::lit_transitions(cycles[i]);
    fusion.add(last);
    if (i == first) {
      sum = last;
      continue;
    }
    std::ranges::transform(sum.values, last.values, sum.values.begin(), std::plus<>());
  }
  std::array<LightField, kInputs.size()> fields;
  E2LF_ASSIGN_OR_RETURN(fields[0], network.reconstruct(last));
  E2LF_ASSIGN_OR_RETURN(fields[1], network.reconstruct({last, fusion.fused()}));
  E2LF_ASSIGN_OR_RETURN(fields[2], network.reconstruct(sum, {}, /*passes=*/1, kFused));
  return fields;
}

/// Returns the PSNR of the pixels of a part, those of which `moves` is `part`, or all for 0, after a fit of their
/// brightness.
double psnr_of_part(const LightField& truth, const LightField& field, const std::vector<uint8_t>& moves, size_t part) {
  const auto [width, height] = std::pair(truth.shape().width, truth.shape().height);
  const auto for_each = [&](const auto& see) {
    for (size_t view = 0; view < truth.shape().num_views(); ++view) {
      for (size_t y = kBorderPx; y + kBorderPx < height; ++y) {
        for (size_t x = kBorderPx; x + kBorderPx < width; ++x) {
          const size_t pixel = y * width + x, i = view * truth.shape().view_size() + pixel;
          if (part == 0 || (moves[pixel] != 0) == (part == 2)) see(truth.data()[i], field.data()[i]);
        }
      }
    }
  };
  double products = 0, squares = 0, errors = 0, count = 0;
  for_each([&](double true_value, double value) { products += true_value * value, squares += value * value, ++count; });
  const double gain = squares > 0 ? products / squares : 1;
  for_each([&](double true_value, double value) {
    const double error = std::clamp(gain * value, 0.0, 1.0) - true_value;
    errors += error * error;
  });
  return -10 * std::log10(errors / count);
}

/// Returns the PSNR of kParts against the view of the scene that is nearest to what moves. Without a part that moves
/// alone, the first one is the only one.
std::vector<double> psnr_of_parts(const LightField& field, const Shot& shot) {
  const size_t parts = shot.moves.empty() ? 1 : kParts.size();
  std::vector<double> best(parts, 0.0);
  for (const LightField& truth : shot.truths) {
    std::vector<double> psnr_db;
    for (size_t part = 0; part < parts; ++part) psnr_db.push_back(psnr_of_part(truth, field, shot.moves, part));
    if (psnr_db.back() > best.back()) best = psnr_db;
  }
  return best;
}

/// Reconstructs the last of kFused cycles of scenes of which nothing, a square or everything moves, and of the
/// turntable: from this cycle alone, from the fused cycles, and from the mean of all. Returns rows with `motion`,
/// `part` and kInputs, which are means over the scenes. `codes` are those of a whole cycle, of which the network takes
/// the lit transitions, and it is conditioned on its camera.
Result<Json> measure_fused(Motions motions, const capture::Codes& codes, const recon::Reconstructor& network,
                           const MotionBench& options, bool is_quiet) {
  for (const double px : {0.0, 6.0}) E2LF_RETURN_IF_ERROR(motions.add_shift(px));
  for (const size_t px : {2U, 4U, 8U}) E2LF_RETURN_IF_ERROR(motions.add_squares(px));
  E2LF_RETURN_IF_ERROR(motions.add_turntable(1.75));
  ProgressBar bar("fusion", is_quiet);
  Json rows = Json::array();
  for (size_t m = 0; m < motions.all().size(); ++m) {
    const std::vector<Shot>& shots = motions.all()[m].shots;
    const size_t parts = shots.front().moves.empty() ? 1 : kParts.size(), first = rows.size();
    for (size_t part = 0; part < parts; ++part) {
      rows.push_back({{"motion", motions.all()[m].name}, {"part", kParts[part]}});
      for (const char* input : kInputs) rows.back()[input] = 0.0;
    }
    for (size_t i = 0; i < shots.size(); ++i) {
      E2LF_ASSIGN_OR_RETURN(const auto cycles,
                            record_cycles(shots[i], codes, *network.model().camera, options.seed + i, kFused + 1));
      E2LF_ASSIGN_OR_RETURN(const auto fields, reconstruct_each(cycles, network));
      for (size_t input = 0; input < kInputs.size(); ++input) {
        const std::vector<double> psnr_db = psnr_of_parts(fields[input], shots[i]);
        for (size_t part = 0; part < parts; ++part) {
          Json& sum = rows[first + part][kInputs[input]];
          sum = sum.get<double>() + psnr_db[part] / static_cast<double>(shots.size());
        }
      }
    }
    bar.update(m + 1, motions.all().size());
  }
  hide_progress();
  return rows;
}

report::Table fused_table(const Json& rows) {
  report::Table table{cat("The last of ", kFused,
                          " cycles, from their lit transitions, after a fit of the brightness of each part; "
                          "means over the scenes."),
                      {{"motion"},
                       {"part"},
                       {"one cycle", true, true, "one_psnr_db"},
                       {"fused", true, true, "fused_psnr_db"},
                       {"mean of all", true, true, "mean_psnr_db"}},
                      {}};
  for (const Json& row : rows) {
    table.rows.push_back(
        {report::text_cell(row["motion"].get<std::string>()), report::text_cell(row["part"].get<std::string>())});
    for (const char* input : kInputs) table.rows.back().push_back(report::number_cell(row[input].get<double>(), 2));
  }
  return table;
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
          {table, fused_table(json["fused"])}};
}

Result<recon::Reconstructor> open_network(const fs::path& path, const capture::SensorProfile& camera) {
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
  if (model::is_conditioned_on_camera(model)) model.camera = camera;
  return recon::Reconstructor::create(std::move(model));
}

Result<Json> bench(const MotionBench& options, const Verb& verb) {
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
  const int64_t cycle_us = cycles::paper_schedule_of(*codes).cycle_us();
  const bool is_quiet = verb.common().quiet;
  Json json = {{"camera", camera.name}, {"size", options.size}};
  E2LF_ASSIGN_OR_RETURN(json["fused"],
                        measure_fused({scenes, options, cycle_us, kFused + 1}, *codes, lit, options, is_quiet));
  E2LF_ASSIGN_OR_RETURN(json["motions"], measure({scenes, options, cycle_us, kCycles}, *codes, camera,
                                                 {std::move(lit), std::move(whole)}, options, is_quiet));
  return json;
}

}  // namespace

int run_motion(const std::vector<std::string>& arguments) {
  Verb verb(
      "motion",
      "Compare the lit transitions with the whole cycle and with fused cycles while the scene moves, in PSNR after a "
      "fit of the brightness.",
      "e2lf-bench motion scene/");
  MotionBench options;
  CLI::App& app = verb.app();
  app.add_option("scenes,-i,--input", options.scenes, "light fields of any format e2lf reads")->required();
  add_model_option(app, "--lit", options.lit, "network of the lit transitions; default: e2lf-n4-camera");
  add_model_option(app, "--whole", options.whole, "network of the whole cycle; default: e2lf-n4-cycle-camera");
  app.add_option("--size", options.size, "height and width of the middle part that is used, px")
      ->check(whole_number(128))
      ->capture_default_str();
  add_camera_option(app, options.camera, "the camera; default: evk4-lcos");
  const auto measure_all = [&]() -> Result<Json> {
    const auto use_bundled = [](fs::path& path, const char* file) {
      if (path.empty()) path = bundled_file(file).value_or(file);
    };
    use_bundled(options.lit, "models/e2lf-n4-camera.safetensors");
    use_bundled(options.whole, "models/e2lf-n4-cycle-camera.safetensors");
    return bench(options, verb);
  };
  const auto describe = [&](const Json& json) { return motion_report(json, options); };
  return run_bench(verb, arguments, measure_all, describe, [&] {
    std::vector<fs::path> inputs = options.scenes;
    inputs.insert(inputs.end(), {options.lit, options.whole});
    return inputs;
  });
}

}  // namespace e2lf::bench
