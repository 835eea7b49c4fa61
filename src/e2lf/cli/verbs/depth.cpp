// SPDX-License-Identifier: MIT
// e2lf depth: light field, or events -> disparity map
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/depth/disparity_picture.h"
#include "e2lf/depth/view_order.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/options.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/sibling_program.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;
namespace {

/// A disparity map with everything that its files contain.
struct DisparityResult {
  depth::DisparityMap map;
  lightfield::Image picture;  ///< of the view, in colour if available
  lightfield::Shape shape;
  std::string name;             ///< of its folder, if there are several
  Json about = Json::object();  ///< what the record says beside the figures of the map
};

/// Returns the next map, or nothing after the last one.
using DisparitySource = std::function<Result<std::optional<DisparityResult>>()>;

struct DisparityOutput {
  std::filesystem::path input, output;
  bool is_one = true;      ///< whether the folder itself gets the files of the one map
  bool is_strict = false;  ///< whether nothing appears before it is known that no data were left out
  float least_confidence = depth::kLeastConfidence;
  std::optional<depth::Lens> lens = {};  ///< without it, points are in units of the distance of disparity 0
};

/// Values that all maps share: they are determined for the first one, so that images and points of a sequence do not
/// jump.
struct Shared {
  std::optional<depth::DisparityRange> shown;
  float infinity = 0;
};

void share(const DisparityOutput& output, const depth::DisparityMap& map, Shared& shared) {
  if (shared.shown) return;
  shared.shown = depth::shown_range(map.disparity, map.confidence);
  shared.infinity = output.lens ? static_cast<float>(output.lens->infinity_px()) : depth::assumed_infinity(map.range);
}

Result<void> write_array(const fs::path& path, const Image& image) {
  return write_npy(path, make_npy<float>({image.height, image.width}, image.pixels));
}

Result<void> write_points(const fs::path& path, const DisparityOutput& output, const DisparityResult& result,
                          const Shared& shared) {
  const depth::PointGeometry geometry{.infinity_px = shared.infinity, .lens = output.lens};
  E2LF_ASSIGN_OR_RETURN(const auto points, pipeline::naming(output.input, depth::encode_point_cloud(
                                                                              result.map, result.picture, result.shape,
                                                                              geometry, output.least_confidence)));
  return write_file(path, points);
}

Result<void> write_one(const fs::path& path, const std::string& extension, const DisparityOutput& output,
                       const DisparityResult& result, const Shared& shared) {
  const Image& disparity = result.map.disparity;
  if (extension == ".npy") return write_array(path, disparity);
  if (extension == ".pfm") return write_file(path, depth::encode_pfm(disparity));
  if (extension == ".ply") return write_points(path, output, result, shared);
  return lightfield::write_png(path, depth::png_samples(disparity), lightfield::PngDepth::k16);
}

Result<void> write_all(const fs::path& folder, const DisparityOutput& output, const DisparityResult& result,
                       const Shared& shared) {
  for (const char* extension : {".npy", ".pfm", ".png", ".ply"}) {
    const std::string name = extension == std::string(".ply") ? "points" : "disparity";
    E2LF_RETURN_IF_ERROR(write_one(folder / (name + extension), extension, output, result, shared));
  }
  if (output.lens) {
    E2LF_RETURN_IF_ERROR(write_array(folder / "metres.npy", depth::depth_image(result.map.disparity, *output.lens)));
  }
  E2LF_RETURN_IF_ERROR(write_array(folder / "confidence.npy", result.map.confidence));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder / "confidence.png", result.map.confidence));
  return lightfield::write_png(folder / "colour.png", depth::picture_with_scale(result.map.disparity, *shared.shown));
}

Json json_of(const DisparityResult& result, const Shared& shared) {
  const depth::DisparityMap& map = result.map;
  Json json = {{"view", {map.view.y, map.view.x}},
               {"height", map.disparity.height},
               {"width", map.disparity.width},
               {"range_px", {json_number(map.range.least), json_number(map.range.most)}},
               {"shown_px", {json_number(shared.shown->least), json_number(shared.shown->most)}},
               {"infinity_px", json_number(shared.infinity)},
               {"mean_confidence", depth::mean_confidence(map)}};
  json.update(result.about);
  return json;
}

void print_maps(const DisparityOutput& output, const CommonOptions& common, const Json& maps, Json printed) {
  const Json& first = maps.front();
  printed.update({{"output", output.output.string()}, {"maps", maps}});
  print_result(common, printed,
               cat(counted(maps.size(), "disparity map"), " in ", output.output.string(),
                   formatted(": view (%d, %d), most of it from %.2f to %.2f px per view step\n",
                             first["view"][0].get<int>(), first["view"][1].get<int>(),
                             first["shown_px"][0].get<double>(), first["shown_px"][1].get<double>())));
}

bool is_disparity_file(const fs::path& output) {
  const std::string extension = output.extension().string();
  return extension == ".npy" || extension == ".pfm" || extension == ".png" || extension == ".ply";
}

/// Writes the maps of `source`: the first one to a file, or one to the folder itself, or one folder for each of them.
/// `finish` is called when there are no more, and returns what is printed with --json beside the maps.
Result<void> write_disparities(const DisparityOutput& output, const DisparitySource& source, RunRecord& record,
                               const Verb& verb, const std::function<Result<Json>()>& finish = {}) {
  std::optional<OutputFile> file;
  std::optional<ResultParts> parts;
  if (is_disparity_file(output.output)) {
    E2LF_ASSIGN_OR_RETURN(file, open_output(output.output, verb));
  } else {
    E2LF_ASSIGN_OR_RETURN(ResultFolder folder, open_output_folder(output.output, verb));
    parts.emplace(std::move(folder), output.is_one, output.is_strict);
  }
  Shared shared;
  Json maps = Json::array();
  const auto step = [&](size_t) -> Result<bool> {
    E2LF_ASSIGN_OR_RETURN(const std::optional<DisparityResult> result, source());
    if (!result) return false;
    share(output, result->map, shared);
    maps.push_back(json_of(*result, shared));
    if (file) {
      E2LF_RETURN_IF_ERROR(write_one(file->path(), output.output.extension().string(), output, *result, shared));
      return output.is_one;
    }
    E2LF_ASSIGN_OR_RETURN(const fs::path place, parts->begin(result->name));
    E2LF_RETURN_IF_ERROR(write_all(place, output, *result, shared));
    E2LF_RETURN_IF_ERROR(parts->commit(result->name, {{"map", maps.back()}}, record));
    return true;
  };
  E2LF_RETURN_IF_ERROR(repeat_until_stopped(step));
  Json printed = Json::object();
  if (finish) {
    E2LF_ASSIGN_OR_RETURN(printed, finish());
  }
  record.end_step("estimate");
  record.note("maps", maps);
  E2LF_RETURN_IF_ERROR(file ? commit(*file, record) : parts->finish(record));
  print_maps(output, verb.common(), maps, std::move(printed));
  return {};
}

struct DepthArguments {
  DisparityOutput output;
  fs::path lens;
  std::optional<float> least, most;
  std::optional<size_t> view_row, view_column;
  LightFieldFlags light_field;
  MethodFlags method;
  CycleFlags cycles;
};

/// An inverted depth order is not an error: the user may want it, and occlusions may mislead.
void warn_of_turned_views(const fs::path& path, const depth::OcclusionSign& sign) {
  if (sign.verdict != depth::OcclusionSign::Verdict::kTurned) return;
  log_warning(cat(path.string(), ": occlusions indicate that the views are turned by 180 degrees (confidence ",
                  std::round(100 * sign.confidence()) / 100, ", ", sign.places,
                  " places), so that near and far are exchanged; give --turn-views"));
}

const char* verdict_name(depth::OcclusionSign::Verdict verdict) {
  using Verdict = depth::OcclusionSign::Verdict;
  return verdict == Verdict::kUpright ? "upright" : verdict == Verdict::kTurned ? "turned" : "undecided";
}

Result<DisparityResult> estimate(const DepthArguments& arguments, const fs::path& path, bool is_quiet) {
  E2LF_ASSIGN_OR_RETURN(
      const LightField light_field,
      load_to_show(path, arguments.light_field, is_quiet, {arguments.least.value_or(0), arguments.most.value_or(0)}));
  depth::DisparityOptions options;
  if (arguments.least) options.range = depth::DisparityRange{*arguments.least, *arguments.most};
  if (arguments.view_row) options.view = depth::ViewIndex{*arguments.view_row, *arguments.view_column};
  ProgressBar bar("depth of " + path.filename().string(), is_quiet);
  E2LF_ASSIGN_OR_RETURN(depth::DisparityMap map,
                        pipeline::naming(path, depth::estimate_disparity(light_field, options, bar.callback())));
  const depth::ViewIndex view = map.view;
  const depth::OcclusionSign sign = depth::occlusion_sign(light_field, map);
  warn_of_turned_views(path, sign);
  const Json occlusion = {
      {"views", verdict_name(sign.verdict)}, {"confidence", json_number(sign.confidence())}, {"places", sign.places}};
  Json about = {{"residual", json_number(map.residual)}, {"occlusion", occlusion}};
  return DisparityResult{std::move(map), lightfield::view_image(light_field, view.y, view.x), light_field.shape(),
                         path.filename().string(), std::move(about)};
}

Result<void> from_light_fields(DepthArguments& arguments, bool are_cycles, const Verb& verb) {
  E2LF_RETURN_IF_ERROR(verb.refuse_options(
      {kCycleOptions, kNetworkOptions, kRecordingOptions, kTableOptions, "--model", "--codes", "--camera",
       "--invert-polarity", "--max-cycles", "--transitions", "--cycles-per-map", "--fuse"},
      "light fields"));
  const fs::path& input = arguments.output.input;
  arguments.output.is_one = !are_cycles;
  RunRecord record(verb, {input});
  const std::vector<fs::path> paths = are_cycles ? lightfield::cycle_folders(input) : std::vector{input};
  const auto source = [&, next = size_t{0}]() mutable -> Result<std::optional<DisparityResult>> {
    if (next == paths.size()) return std::optional<DisparityResult>();
    E2LF_ASSIGN_OR_RETURN(DisparityResult result, estimate(arguments, paths[next++], verb.common().quiet));
    return std::optional(std::move(result));
  };
  return write_disparities(arguments.output, source, record, verb);
}

Result<void> from_events(DepthArguments& arguments, const Verb& verb) {
  E2LF_RETURN_IF_ERROR(verb.refuse_options({kLightFieldOptions, "--min-disparity", "--view-row"}, "events"));
  // Before there is an output, because the program that continues would find it unfinished.
  E2LF_RETURN_IF_ERROR(require_device(arguments.method.choice.device));
  if (arguments.method.choice.use.fused_cycles > 1 && is_disparity_file(arguments.output.output)) {
    return fail(ErrorCode::kInvalidValue, "--fuse",
                "there is a map of each cycle, and a file holds the first one, which is not fused; name a folder as "
                "the output, or give --cycles-per-map for a still scene");
  }
  const fs::path& path = arguments.output.input;
  RunRecord record(verb);
  arguments.method.choice.algorithm = pipeline::Algorithm::kDepth;
  E2LF_ASSIGN_OR_RETURN(pipeline::EventRun run, open_event_run(path, arguments.cycles, arguments.method,
                                                               arguments.light_field.orientation, verb, record));
  EventRunLog log(run, path, record);
  arguments.output.is_one = run.input().has_one_field();
  arguments.output.is_strict = arguments.cycles.recording.is_strict;
  const auto source = [&, number = size_t{0}]() mutable -> Result<std::optional<DisparityResult>> {
    const std::string name = cycle_name(number++);
    ProgressBar bar("depth of " + name, verb.common().quiet || is_live(path));
    E2LF_ASSIGN_OR_RETURN(std::optional<pipeline::EventResult> result, run.next(bar.callback()));
    if (!result) return std::optional<DisparityResult>();
    Json about = log.add(*result);
    auto& made = std::get<pipeline::EventDepth>(result->made);
    const model::Model& model = run.method().network->model();
    const lightfield::Shape shape{model.views_y, model.views_x, made.picture.height, made.picture.width};
    return std::optional(DisparityResult{std::move(made.map), std::move(made.picture), shape, name, std::move(about)});
  };
  return write_disparities(arguments.output, source, record, verb, [&] { return log.finish(verb, record); });
}

Result<void> run(DepthArguments& arguments, const Verb& verb) {
  if (!arguments.lens.empty()) {
    E2LF_ASSIGN_OR_RETURN(arguments.output.lens, depth::read_lens(arguments.lens));
  }
  const fs::path& input = arguments.output.input;
  if (is_live(input)) return from_events(arguments, verb);
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(input));
  if (kind == FileKind::kRecording || kind == FileKind::kEventImages) return from_events(arguments, verb);
  const bool are_cycles = kind == FileKind::kCycles && !is_disparity_file(arguments.output.output);
  if (kind != FileKind::kLightField && !are_cycles) return other_kind_error(input, kind, "a light field");
  return from_light_fields(arguments, are_cycles, verb);
}

void add_output_options(CLI::App& app, DisparityOutput& output) {
  app.add_option("input,-i,--input", output.input,
                 "light field, or folder of cycles; or events: event images (.npz), a recording, - for standard input, "
                 "camera://NAME, ...")
      ->required();
  app.add_option("-o,--output", output.output,
                 "folder to write, or a file: .npy or .pfm (float32), .png (16 bits, 32768 + 4096 * disparity) or .ply "
                 "(points); of events of several cycles, a file contains the first one")
      ->required();
}

void add_map_options(CLI::App& app, DepthArguments& arguments) {
  const OptionGroup group(app, kMapOptions);
  app.add_option(
      "--lens", arguments.lens,
      "calibrated lens (JSON of examples/lens/calibrate_lens.py): points in metres, and metres.npy in the folder");
  app.add_option("--least-confidence", arguments.output.least_confidence, "points: smallest confidence of a point")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add_pair(
      app.add_option("--min-disparity", arguments.least, "disparity of the nearest points, px per view step"),
      app.add_option("--max-disparity", arguments.most,
                     "disparity of the farthest points, px per view step; default of both: estimated, within 6 px"));
  add_pair(app.add_option("--view-row", arguments.view_row,
                          "view for whose pixels the disparity is estimated; default: the middle one, (4, 4)"),
           app.add_option("--view-column", arguments.view_column, "column of this view"));
}

}  // namespace

int run_depth(const std::vector<std::string>& arguments) {
  Verb verb("depth",
            "Estimate the disparity of every pixel of a view, with a confidence, from all views of a light field, or "
            "from events by a depth network.",
            "e2lf depth out/demo/recon -o out/depth");
  DepthArguments depth_arguments;
  CLI::App& app = verb.app();
  add_output_options(app, depth_arguments.output);
  add_map_options(app, depth_arguments);
  add_light_field_options(app, depth_arguments.light_field, /*has_views=*/true);
  add_orientation_options(app, depth_arguments.light_field.orientation);
  add_method_options(app, depth_arguments.method, "the file of the events");
  add_count(app, "--cycles-per-map", depth_arguments.method.choice.use.cycles, 1, 64,
            "events: number of cycles of a static scene from which each map is estimated");
  add_fuse_option(app, depth_arguments.method.choice.use.fused_cycles, "map");
  add_cycle_options(app, depth_arguments.cycles);
  verb.stop_gently();
  return verb.run(arguments, [&] { return run(depth_arguments, verb); });
}

}  // namespace e2lf::cli
