// SPDX-License-Identifier: MIT
// e2lf-bench depth: compares disparity maps with true ones, and determines the sign of the disparities from occlusions
// for light fields as they are and turned by 180 degrees.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/program/parts.h"
#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/depth/view_order.h"
#include "e2lf/eval/report.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/verb.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;

/// A light field with the true disparities of its middle view, if they are known.
struct DepthScene {
  std::string name;
  LightField light_field;
  Image truth;
};

/// Returns the scene of `e2lf demo --seed 1`.
DepthScene demo() {
  const lightfield::Shape shape{8, 8, 384, 512, 1};
  const lightfield::ProceduralScene scene = lightfield::demo_scene(1);
  return {"demo scene", lightfield::render_light_field(scene, shape),
          lightfield::render_disparity(scene, {shape.height, shape.width, 0.5F, 0.5F})};
}

Result<DepthScene> read(const fs::path& path) {
  DepthScene scene{path.filename().string(), {}, {}};
  E2LF_ASSIGN_OR_RETURN(scene.light_field, load_scene(path, SceneOptions{}, true));
  const auto file = depth::find_true_disparity(path);
  if (!file) return scene;
  E2LF_ASSIGN_OR_RETURN(depth::TrueDisparity truth, depth::true_disparity(scene.light_field, file));
  scene.truth = std::move(truth.disparity);
  return scene;
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
    E2LF_ASSIGN_OR_RETURN(const depth::DisparityError error,
                          depth::compare(map.disparity, map.confidence, scene.truth));
    json["error"] = eval::to_json(error);
  }
  json["as_is"] = sign_json(depth::occlusion_sign(scene.light_field, map));
  lightfield::orient(scene.light_field, capture::kTurned);
  E2LF_ASSIGN_OR_RETURN(const depth::DisparityMap turned, depth::estimate_disparity(scene.light_field));
  json["turned"] = sign_json(depth::occlusion_sign(scene.light_field, turned));
  return json;
}

BenchReport depth_report(const Json& json) {
  report::Table table{"The order of the views according to the occlusions, for the views as they are and turned.",
                      {{"scene"},
                       {"bad at 0.2 px, %", true},
                       {"at 0.07 px, %", true},
                       {"mean error, px", true},
                       {"seconds", true},
                       {"as it is"},
                       {"turned"}},
                      {}};
  for (const Json& scene : json["scenes"]) {
    std::vector<report::Cell> row = {report::text_cell(scene["scene"].get<std::string>())};
    const Json error = scene.value("error", Json::object());
    for (const auto& [figure, decimals] :
         {std::pair("bad_20_percent", 2), {"bad_07_percent", 2}, {"mean_absolute_px", 3}}) {
      row.push_back(error.contains(figure) ? report::number_cell(error[figure].get<double>(), decimals)
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
  return {
      "Disparity maps",
      "Disparity maps of the middle view. Bad pixels have a larger error than stated; a border of 15 px is left out. "
      "The truth is known for the demo scene and for folders with gt_disparity.npy.",
      {table}};
}

}  // namespace

int run_depth(const std::vector<std::string>& arguments) {
  Verb verb("depth",
            "Measure the errors of disparity maps for the demo scene and for light fields with true disparities, and "
            "determine the order of the views from occlusions.",
            "e2lf-bench depth scene/");
  std::vector<fs::path> paths;
  verb.app().add_option("scenes,-i,--input", paths, "light fields of any format e2lf reads");
  const auto measure_all = [&]() -> Result<Json> {
    ProgressBar bar("depth", verb.common().quiet);
    Json scenes = Json::array();
    E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), measure(demo()));
    for (const fs::path& path : paths) {
      bar.update(scenes.size(), paths.size() + 1);
      E2LF_ASSIGN_OR_RETURN(DepthScene scene, read(path));
      E2LF_ASSIGN_OR_RETURN(scenes.emplace_back(), measure(std::move(scene)));
    }
    return Json{{"scenes", std::move(scenes)}};
  };
  return run_bench(verb, arguments, measure_all, depth_report, [&] { return paths; });
}

}  // namespace e2lf::bench
