// SPDX-License-Identifier: MIT
// e2lf depth: light field -> disparity map
#include <cmath>

#include "e2lf/base/format.h"
#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/colour_scale.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/depth/view_order.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/options.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/lightfield/crop.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/program/light_field_flags.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;
namespace {

struct DepthArguments {
  fs::path input, output;
  float least = 0, most = 0;
  size_t view_row = 0, view_column = 0;
  float infinity = 0, field_width = 0.8F, least_confidence = 0.1F;
  bool has_range = false, has_view = false;
  LightFieldFlags light_field{.views = 0};
};

/// A disparity map with everything that its files contain.
struct Estimate {
  depth::DisparityMap map;
  Image picture;  ///< the view, in colour if available
  lightfield::Shape shape;
  depth::OcclusionSign sign;
};

/// Values that all cycles share: they are determined for the first one, so that images and points of a sequence do not
/// jump.
struct Shared {
  std::optional<depth::DisparityRange> shown;
  float infinity = 0;
};

/// An inverted depth order is not an error: the user may want it, and occlusions may mislead.
void warn_of_turned_views(const fs::path& path, const depth::OcclusionSign& sign) {
  if (sign.verdict != depth::OcclusionSign::Verdict::kTurned) return;
  log_warning(cat(path.string(), ": occlusions indicate that the views are turned by 180 degrees (confidence ",
                  std::round(100 * sign.confidence()) / 100, ", ", sign.places,
                  " places), so that near and far are exchanged; give --turn-views"));
}

void warn_of_flipped_views(const fs::path& path, depth::FlippedAxis axis) {
  const char* options[] = {"", "--flip-x", "--flip-y", "--flip-x or --flip-y, whichever makes near objects near"};
  if (axis == depth::FlippedAxis::kNone) return;
  log_warning(cat(path.string(), ": the views are probably flipped along one axis: no depth fits all of them, but one ",
                  "does after flipping; give ", options[static_cast<size_t>(axis)]));
}

const char* verdict_name(depth::OcclusionSign::Verdict verdict) {
  using Verdict = depth::OcclusionSign::Verdict;
  return verdict == Verdict::kUpright ? "upright" : verdict == Verdict::kTurned ? "turned" : "undecided";
}

Result<Estimate> estimate(const DepthArguments& arguments, const fs::path& path, bool is_quiet) {
  E2LF_ASSIGN_OR_RETURN(const LightField light_field,
                        load_to_show(path, arguments.light_field, is_quiet, {arguments.least, arguments.most}));
  depth::DisparityOptions options;
  if (arguments.has_range) options.range = depth::DisparityRange{arguments.least, arguments.most};
  if (arguments.has_view) options.view = depth::ViewIndex{arguments.view_row, arguments.view_column};
  ProgressBar bar("depth of " + path.filename().string(), is_quiet);
  E2LF_ASSIGN_OR_RETURN(depth::DisparityMap map,
                        located(depth::estimate_disparity(light_field, options, bar.callback()), path));
  const depth::ViewIndex view = map.view;
  const depth::OcclusionSign sign = depth::occlusion_sign(light_field, map);
  warn_of_turned_views(path, sign);
  E2LF_ASSIGN_OR_RETURN(const depth::FlippedAxis axis, depth::find_flipped_axis(light_field, map));
  warn_of_flipped_views(path, axis);
  return Estimate{std::move(map), lightfield::view_image(light_field, view.y, view.x), light_field.shape(), sign};
}

void share(const DepthArguments& arguments, const depth::DisparityMap& map, Shared& shared) {
  if (shared.shown) return;
  shared.shown = depth::shown_range(map);
  shared.infinity = arguments.infinity > 0 ? arguments.infinity : depth::assumed_infinity(map.range);
}

Result<void> write_array(const fs::path& path, const Image& image) {
  return write_npy(path, make_npy<float>({image.height, image.width}, image.pixels));
}

Result<void> write_points(const fs::path& path, const DepthArguments& arguments, const Estimate& estimate,
                          const Shared& shared) {
  E2LF_ASSIGN_OR_RETURN(
      const auto points,
      located(depth::encode_point_cloud(estimate.map, estimate.picture, estimate.shape,
                                        {shared.infinity, arguments.field_width}, arguments.least_confidence),
              arguments.input));
  return write_file(path, points);
}

/// Writes one file in the format of its extension.
Result<void> write_one(const fs::path& path, const std::string& extension, const DepthArguments& arguments,
                       const Estimate& estimate, const Shared& shared) {
  const Image& disparity = estimate.map.disparity;
  if (extension == ".npy") return write_array(path, disparity);
  if (extension == ".pfm") return write_file(path, depth::encode_pfm(disparity));
  if (extension == ".ply") return write_points(path, arguments, estimate, shared);
  return lightfield::write_png(path, depth::png_samples(disparity), lightfield::PngDepth::k16);
}

Result<void> write_all(const fs::path& folder, const DepthArguments& arguments, const Estimate& estimate,
                       const Shared& shared) {
  for (const char* extension : {".npy", ".pfm", ".png", ".ply"}) {
    const std::string name = extension == std::string(".ply") ? "points" : "disparity";
    E2LF_RETURN_IF_ERROR(write_one(folder / (name + extension), extension, arguments, estimate, shared));
  }
  E2LF_RETURN_IF_ERROR(write_array(folder / "confidence.npy", estimate.map.confidence));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder / "confidence.png", estimate.map.confidence));
  return lightfield::write_png(folder / "colour.png", depth::picture_with_scale(estimate.map.disparity, *shared.shown));
}

Json json_of(const Estimate& estimate, const Shared& shared) {
  const depth::DisparityMap& map = estimate.map;
  return {{"view", {map.view.y, map.view.x}},
          {"height", map.disparity.height},
          {"width", map.disparity.width},
          {"range_px", {json_number(map.range.least), json_number(map.range.most)}},
          {"shown_px", {json_number(shared.shown->least), json_number(shared.shown->most)}},
          {"infinity_px", json_number(shared.infinity)},
          {"residual", json_number(map.residual)},
          {"occlusion",
           {{"views", verdict_name(estimate.sign.verdict)},
            {"confidence", json_number(estimate.sign.confidence())},
            {"places", estimate.sign.places}}},
          {"mean_confidence", depth::mean_confidence(map)}};
}

void print_maps(const DepthArguments& arguments, const CommonOptions& common, const Json& maps) {
  const Json& first = maps.front();
  print_result(common, {{"output", arguments.output.string()}, {"maps", maps}},
               cat(counted(maps.size(), "disparity map"), " in ", arguments.output.string(),
                   formatted(": view (%d, %d), most of it from %.2f to %.2f px per view step\n",
                             first["view"][0].get<int>(), first["view"][1].get<int>(),
                             first["shown_px"][0].get<double>(), first["shown_px"][1].get<double>())));
}

Result<void> to_file(const DepthArguments& arguments, const std::string& extension, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, {arguments.input}));
  RunRecord record("depth", {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const Estimate result, estimate(arguments, arguments.input, verb.common().quiet));
  record.end_step("estimate");
  Shared shared;
  share(arguments, result.map, shared);
  E2LF_RETURN_IF_ERROR(write_one(output.path(), extension, arguments, result, shared));
  record.note("maps", Json::array({json_of(result, shared)}));
  E2LF_RETURN_IF_ERROR(commit(output, record, verb));
  print_maps(arguments, verb.common(), Json::array({json_of(result, shared)}));
  return {};
}

/// Writes the folder of a light field, or one folder for each cycle, which appears complete when it is done.
Result<void> to_folder(const DepthArguments& arguments, const std::vector<fs::path>& cycles, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(ResultFolder output, open_output_folder(arguments.output, verb, {arguments.input}));
  RunRecord record("depth", {arguments.input});
  Shared shared;
  Json maps = Json::array();
  const bool is_one = cycles.empty();
  for (const fs::path& cycle : is_one ? std::vector{arguments.input} : cycles) {
    if (!maps.empty() && stop_requested()) break;
    const auto result = estimate(arguments, cycle, verb.common().quiet);
    if (!result && result.error().code == ErrorCode::kCancelled && !maps.empty()) break;
    if (!result) return result.error();
    share(arguments, result->map, shared);
    maps.push_back(json_of(*result, shared));
    const std::string name = cycle.filename().string();
    fs::path folder = output.path();
    if (!is_one) {
      E2LF_ASSIGN_OR_RETURN(folder, output.begin_part(name));
    }
    E2LF_RETURN_IF_ERROR(write_all(folder, arguments, *result, shared));
    if (is_one) break;
    E2LF_RETURN_IF_ERROR(output.commit_part(name, {{"map", maps.back()}}));
    if (maps.size() == 1) E2LF_RETURN_IF_ERROR(output.commit(record.json_so_far(verb)));
  }
  record.end_step("estimate");
  record.note("maps", maps);
  E2LF_ASSIGN_OR_RETURN(Json about, record.json(verb));
  E2LF_RETURN_IF_ERROR(is_one ? output.commit(std::move(about)) : output.update_record(std::move(about)));
  print_maps(arguments, verb.common(), maps);
  return {};
}

Result<void> run(DepthArguments& arguments, const Verb& verb) {
  if (verb.is_given("--min-disparity") != verb.is_given("--max-disparity")) {
    return Error{ErrorCode::kInvalidValue, "a range has two limits; give --min-disparity and --max-disparity", ""};
  }
  if (verb.is_given("--view-row") != verb.is_given("--view-column")) {
    return Error{ErrorCode::kInvalidValue, "a view has a row and a column; give --view-row and --view-column", ""};
  }
  arguments.has_range = verb.is_given("--min-disparity");
  arguments.has_view = verb.is_given("--view-row");
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(arguments.input));
  const std::string extension = arguments.output.extension().string();
  const bool is_file = extension == ".npy" || extension == ".pfm" || extension == ".png" || extension == ".ply";
  if (kind == FileKind::kCycles && !is_file) {
    return to_folder(arguments, lightfield::cycle_folders(arguments.input), verb);
  }
  if (kind != FileKind::kLightField) return no_light_field_error(arguments.input);
  return is_file ? to_file(arguments, extension, verb) : to_folder(arguments, {}, verb);
}

}  // namespace

int run_depth(const std::vector<std::string>& arguments) {
  Verb verb("depth",
            "Estimate the disparity of every pixel of a view, with a confidence, from all views of a light field.",
            "e2lf depth out/demo/recon -o out/depth");
  DepthArguments depth_arguments;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", depth_arguments.input, "light field, or folder of cycles")->required();
  app.add_option("-o,--output", depth_arguments.output,
                 "folder to write, or a file: .npy or .pfm (float32), .png (16 bits, 32768 + 4096 * disparity) or .ply "
                 "(points)")
      ->required();
  app.add_option("--min-disparity", depth_arguments.least, "disparity of the nearest points, px per view step");
  app.add_option("--max-disparity", depth_arguments.most,
                 "disparity of the farthest points, px per view step; default of both: estimated, within 6 px");
  app.add_option("--view-row", depth_arguments.view_row,
                 "view for whose pixels the disparity is estimated; default: the middle one, (4, 4)");
  app.add_option("--view-column", depth_arguments.view_column, "column of this view");
  app.add_option("--infinity", depth_arguments.infinity,
                 "points: disparity at infinite distance, px per view step; default: assumed, see run.json")
      ->check(positive_number());
  app.add_option("--field-width", depth_arguments.field_width,
                 "points: width of the field of view at disparity 0, in units of its distance")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--least-confidence", depth_arguments.least_confidence, "points: smallest confidence of a point")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add_light_field_options(app, depth_arguments.light_field, /*has_views=*/true);
  add_orientation_options(app, depth_arguments.light_field.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return run(depth_arguments, verb); });
}

}  // namespace e2lf::cli
