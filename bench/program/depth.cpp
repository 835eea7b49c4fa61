// SPDX-License-Identifier: MIT
// e2lf-bench depth: compares disparity maps with true ones, and determines the sign of the disparities from occlusions
// for light fields as they are and turned by 180 degrees.
#include "bench/program/depth.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "bench/program/report.h"
#include "e2lf/base/text.h"
#include "e2lf/depth/view_order.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/demo_scene.h"
#include "e2lf/lightfield/orient.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/program/light_field_flags.h"
#include "e2lf/program/run_record.h"
#include "e2lf/program/verb.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;

constexpr const char* kTruthFile = "gt_disparity.npy";

/// A light field with the true disparities of its middle view, if they are known.
struct DepthScene {
  std::string name;
  LightField light_field;
  Image truth;
};

/// Returns the scene of `e2lf demo --seed 1`.
DepthScene demo() {
  const lightfield::Shape shape{8, 8, 384, 512, 1};
  const lightfield::Scene scene = lightfield::demo_scene(1);
  return {"demo scene", lightfield::render_light_field(scene, shape),
          lightfield::render_disparity(scene, {shape.height, shape.width, 0.5F, 0.5F})};
}

Result<DepthScene> read(const fs::path& path) {
  DepthScene scene{path.filename().string(), {}, {}};
  E2LF_ASSIGN_OR_RETURN(scene.light_field, load_scene(path, SceneOptions{}, true));
  const fs::path truth = path / kTruthFile;
  if (!fs::exists(truth)) return scene;
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(truth));
  const lightfield::Shape& shape = scene.light_field.shape();
  if (!std::ranges::equal(array.shape, std::array{shape.height, shape.width})) {
    return Error{ErrorCode::kShape, "these disparities do not have the size of the views", truth.string()};
  }
  scene.truth = Image(shape.width, shape.height, 1);
  E2LF_ASSIGN_OR_RETURN(scene.truth.pixels, array.to_float(truth.string()));
  return scene;
}

/// Returns the share of pixels, 8 px from the borders or more, whose error is above `most_px`.
double bad_pixels(const Image& disparity, const Image& truth, float most_px) {
  constexpr size_t kMargin = 8;
  double bad = 0, count = 0;
  for (size_t y = kMargin; y + kMargin < truth.height; ++y) {
    for (size_t x = kMargin; x + kMargin < truth.width; ++x, ++count) {
      const size_t i = y * truth.width + x;
      bad += std::abs(disparity.pixels[i] - truth.pixels[i]) > most_px ? 1 : 0;
    }
  }
  return bad / count;
}

Json sign_json(const depth::OcclusionSign& sign) {
  constexpr const char* kVerdicts[] = {"undecided", "upright", "turned"};
  return {{"verdict", kVerdicts[static_cast<int>(sign.verdict)]},
          {"places", sign.places},
          {"confidence", sign.confidence()}};
}

Result<Json> measure(DepthScene scene) {
  Json json = {{"scene", scene.name}};
  const auto begin = std::chrono::steady_clock::now();
  E2LF_ASSIGN_OR_RETURN(const depth::DisparityMap map, depth::estimate_disparity(scene.light_field));
  json["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!scene.truth.pixels.empty()) {
    for (const float px : {0.2F, 0.07F, 0.03F}) {
      json["bad"].push_back({{"above_px", px}, {"share", bad_pixels(map.disparity, scene.truth, px)}});
    }
  }
  json["as_is"] = sign_json(depth::occlusion_sign(scene.light_field, map));
  lightfield::orient(scene.light_field, capture::kTurned);
  E2LF_ASSIGN_OR_RETURN(const depth::DisparityMap turned, depth::estimate_disparity(scene.light_field));
  json["turned"] = sign_json(depth::occlusion_sign(scene.light_field, turned));
  return json;
}

BenchReport depth_report(const Json& scenes) {
  report::Table table{"The order of the views according to the occlusions, for the views as they are and turned.",
                      {{"scene"},
                       {"bad at 0.2 px, %", true},
                       {"at 0.07 px, %", true},
                       {"at 0.03 px, %", true},
                       {"seconds", true},
                       {"as it is"},
                       {"turned"}},
                      {}};
  for (const Json& scene : scenes) {
    std::vector<report::Cell> row = {report::text_cell(scene["scene"].get<std::string>())};
    for (size_t i = 0; i < 3; ++i) {
      row.push_back(scene.contains("bad") ? report::number_cell(100 * scene["bad"][i]["share"].get<double>(), 2)
                                          : report::Cell{});
    }
    row.push_back(report::number_cell(scene["seconds"].get<double>(), 2));
    for (const char* order : {"as_is", "turned"}) {
      const Json& sign = scene[order];
      row.push_back(report::text_cell(cat(sign["verdict"].get<std::string>(), ", ",
                                          std::lround(100 * sign["confidence"].get<double>()), " % of ",
                                          sign["places"].get<size_t>(), " places")));
    }
    table.rows.push_back(std::move(row));
  }
  return {"Disparity maps",
          cat("Disparity maps of the middle view. Bad pixels have a larger error than stated. The truth is known for "
              "the demo scene and for folders with ",
              kTruthFile),
          {table}};
}

Result<void> bench(const std::vector<fs::path>& paths, const std::vector<fs::path>& report_names, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(report_names, output_rules(verb, paths)));
  ProgressBar bar("depth", verb.common().quiet);
  Json scenes = Json::array();
  E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), measure(demo()));
  for (const fs::path& path : paths) {
    bar.update(scenes.size(), paths.size() + 1);
    E2LF_ASSIGN_OR_RETURN(DepthScene scene, read(path));
    E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), measure(std::move(scene)));
  }
  hide_progress();
  return finish(verb, {{"scenes", scenes}}, depth_report(scenes), reports);
}

}  // namespace

int run_depth(const std::vector<std::string>& arguments) {
  Verb verb("depth",
            "Measure the errors of disparity maps for the demo scene and for light fields with true disparities, and "
            "determine the order of the views from occlusions.",
            "e2lf-bench depth scene/");
  std::vector<fs::path> scenes, report_names;
  CLI::App& app = verb.app();
  add_report_option(app, report_names);
  app.add_option("scenes,-i,--input", scenes, "light fields of any format e2lf reads");
  return verb.run(arguments, [&]() -> Result<void> { return bench(scenes, report_names, verb); });
}

}  // namespace e2lf::bench
