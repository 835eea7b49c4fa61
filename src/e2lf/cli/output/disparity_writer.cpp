// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/disparity_writer.h"

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/depth/colour_scale.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/depth/view_order.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
namespace {

/// Values that all maps share: they are determined for the first one, so that images and points of a sequence do not
/// jump.
struct Shared {
  std::optional<depth::DisparityRange> shown;
  float infinity = 0;
};

void share(const DisparityOutput& output, const depth::DisparityMap& map, Shared& shared) {
  if (shared.shown) return;
  shared.shown = depth::shown_range(map);
  shared.infinity = output.lens ? static_cast<float>(output.lens->infinity_px()) : depth::assumed_infinity(map.range);
}

Result<void> write_array(const fs::path& path, const Image& image) {
  return write_npy(path, make_npy<float>({image.height, image.width}, image.pixels));
}

Result<void> write_points(const fs::path& path, const DisparityOutput& output, const DisparityResult& result,
                          const Shared& shared) {
  const depth::PointGeometry geometry{.infinity_px = shared.infinity, .lens = output.lens};
  E2LF_ASSIGN_OR_RETURN(const auto points, located(depth::encode_point_cloud(result.map, result.picture, result.shape,
                                                                             geometry, output.least_confidence),
                                                   output.input));
  return write_file(path, points);
}

/// Writes one file in the format of its extension.
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

void print_maps(const DisparityOutput& output, const CommonOptions& common, const Json& maps) {
  const Json& first = maps.front();
  print_result(common, {{"output", output.output.string()}, {"maps", maps}},
               cat(counted(maps.size(), "disparity map"), " in ", output.output.string(),
                   formatted(": view (%d, %d), most of it from %.2f to %.2f px per view step\n",
                             first["view"][0].get<int>(), first["view"][1].get<int>(),
                             first["shown_px"][0].get<double>(), first["shown_px"][1].get<double>())));
}

Error no_map_error(const DisparityOutput& output) {
  return {ErrorCode::kNotFound, "there is no complete cycle; give a longer recording", output.input.string()};
}

Result<void> to_file(const DisparityOutput& output, const DisparitySource& source, RunRecord& record,
                     const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(OutputFile file, open_output(output.output, verb, {output.input}));
  E2LF_ASSIGN_OR_RETURN(const std::optional<DisparityResult> result, source());
  if (!result) return no_map_error(output);
  record.end_step("estimate");
  Shared shared;
  share(output, result->map, shared);
  E2LF_RETURN_IF_ERROR(write_one(file.path(), output.output.extension().string(), output, *result, shared));
  record.note("maps", Json::array({json_of(*result, shared)}));
  E2LF_RETURN_IF_ERROR(commit(file, record, verb));
  print_maps(output, verb.common(), Json::array({json_of(*result, shared)}));
  return {};
}

/// Writes the folder of one map, or one folder for each of them, which appears complete when it is done.
Result<void> to_folder(const DisparityOutput& output, const DisparitySource& source, RunRecord& record,
                       const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(ResultFolder folder, open_output_folder(output.output, verb, {output.input}));
  Shared shared;
  Json maps = Json::array();
  while (maps.empty() || !stop_requested()) {
    const auto result = source();
    if (!result && result.error().code == ErrorCode::kCancelled && !maps.empty()) break;
    if (!result) return result.error();
    if (!*result) break;
    share(output, (*result)->map, shared);
    maps.push_back(json_of(**result, shared));
    fs::path part = folder.path();
    if (!output.is_one) {
      E2LF_ASSIGN_OR_RETURN(part, folder.begin_part((*result)->name));
    }
    E2LF_RETURN_IF_ERROR(write_all(part, output, **result, shared));
    if (output.is_one) break;
    E2LF_RETURN_IF_ERROR(folder.commit_part((*result)->name, {{"map", maps.back()}}));
    if (maps.size() == 1) E2LF_RETURN_IF_ERROR(folder.commit(record.json_so_far(verb)));
  }
  if (maps.empty()) return no_map_error(output);
  record.end_step("estimate");
  record.note("maps", maps);
  E2LF_ASSIGN_OR_RETURN(Json about, record.json(verb));
  E2LF_RETURN_IF_ERROR(output.is_one ? folder.commit(std::move(about)) : folder.update_record(std::move(about)));
  print_maps(output, verb.common(), maps);
  return {};
}

}  // namespace

bool is_disparity_file(const fs::path& output) {
  const std::string extension = output.extension().string();
  return extension == ".npy" || extension == ".pfm" || extension == ".png" || extension == ".ply";
}

Result<void> write_disparities(const DisparityOutput& output, const DisparitySource& source, RunRecord& record,
                               const Verb& verb) {
  return is_disparity_file(output.output) ? to_file(output, source, record, verb)
                                          : to_folder(output, source, record, verb);
}

}  // namespace e2lf::cli
