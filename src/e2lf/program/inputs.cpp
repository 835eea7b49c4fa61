// SPDX-License-Identifier: MIT
#include "e2lf/program/inputs.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/program/options.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::program {
namespace fs = std::filesystem;
using pipeline::KnownCodes;
namespace {

/// Declares an option for a file, or for several, by path or bundled name. For missing files, throws the parser's
/// exception.
template <typename Paths>
CLI::Option* add_named(CLI::App& app, const std::string& flags, const BundledKind& kind, const char* type, Paths& paths,
                       const std::string& help) {
  const std::string own_name = flags.substr(flags.rfind(',') + 1);
  const auto take = [&paths, &kind, own_name](const CLI::results_t& names) {
    paths.clear();
    for (const std::string& name : names) {
      auto path = find_file_or_bundled(kind, name);
      if (!path) throw CLI::FileError(cat(path.error().text(), " (", own_name, ")"));
      if constexpr (std::is_same_v<Paths, fs::path>) {
        paths = *std::move(path);
      } else {
        paths.push_back(*std::move(path));
      }
    }
    return true;
  };
  return app.add_option(flags, take, help)->type_name(type);
}

}  // namespace

CLI::Option* add_model_option(CLI::App& app, const std::string& flags, fs::path& model, const std::string& help) {
  return add_named(app, flags, kBundledModels, kModelType, model, help);
}

CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::vector<fs::path>& models,
                              const std::string& help) {
  return add_named(app, flags, kBundledModels, kModelType, models, help)
      ->expected(1, CLI::detail::expected_max_vector_size);
}

CLI::Option* add_codes_option(CLI::App& app, fs::path& codes, const std::string& help) {
  return add_named(app, "--codes", kBundledCodes, kCodesType, codes, help);
}

void add_camera_option(CLI::App& app, std::string& camera, const std::string& help) {
  app.add_option("--camera", camera,
                 cat("camera file (JSON) or one of ", join(bundled_names(kBundledCameras)), ": ", help))
      ->type_name(kCameraType);
}

Result<fs::path> find_camera(const std::string& name) {
  return find_file_or_bundled(kBundledCameras, name);
}

Result<capture::SensorProfile> load_camera(const std::string& name, RunRecord& record) {
  const auto path = find_camera(name);
  if (!path) return Error(path.error()).about("camera");
  record.add_input(*path);
  E2LF_ASSIGN_OR_RETURN(capture::SensorProfile camera, capture::read_camera(*path));
  record.note("camera", capture::to_json(camera));
  return camera;
}

void add_codes_options(CLI::App& app, CodesSource& source) {
  add_model_option(app, "-m,--model", source.model,
                   "model file, or the name of a bundled model: its patterns and sensor constants");
  add_codes_option(app, source.codes,
                   "aperture patterns (.json, .npy, .npz, or a model); default: those in the file of the events, or "
                   "else those of the model; without either, simulations and the inversion take those of e2lf-n4");
}

Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record) {
  if (source.model.empty()) return std::optional<model::Model>();
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(source.model));
  record.add_input(source.model, bytes);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::decode_model(bytes, source.model.string(), folder_of(source.model)));
  for (const fs::path& part : model.parts) record.add_input(part);
  return std::optional(std::move(model));
}

Result<std::optional<KnownCodes>> find_codes(const CodesSource& source, const std::optional<model::Model>& model,
                                             const std::optional<capture::Codes>& of_events, RunRecord& record) {
  std::optional<capture::Codes> named;
  if (!source.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(named, pipeline::read_patterns(source.codes));
  }
  if (named) record.add_input(source.codes);
  if (named && of_events && *named != *of_events) {
    log_warning(cat("the patterns of ", source.codes.string(), " differ from those in the file of the events; ",
                    "using those of --codes"));
  }
  return pipeline::known_codes(named, of_events, model ? &*model : nullptr);
}

Result<KnownCodes> load_codes(const CodesSource& source, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const std::optional<model::Model> model, read_named_model(source, record));
  E2LF_ASSIGN_OR_RETURN(std::optional<KnownCodes> known, find_codes(source, model, std::nullopt, record));
  if (known) return std::move(*known);
  if (!source.model.empty()) {
    return fail(ErrorCode::kNotFound, source.model, "the model contains no aperture patterns; give them with --codes");
  }
  known.emplace();
  E2LF_ASSIGN_OR_RETURN(known->codes, pipeline::usual_patterns());
  if (const auto path = bundled_model()) {
    record.add_input(*path);
    record.resolve("codes", path->stem().string());
    log_info(cat("no patterns were given; using those of ", path->stem().string()));
  }
  return std::move(*known);
}

void add_orientation_options(CLI::App& app, OrientationFlags& flags) {
  const OptionGroup group(app, kOrientationOptions);
  app.add_flag("--turn-views", flags.turn_views,
               "turn the grid of views by 180 degrees in addition to what files state, which changes the sign of every "
               "disparity");
  app.add_flag("--flip-x", flags.flip_x,
               "exchange left and right views, which changes the sign of horizontal disparities");
  app.add_flag("--flip-y", flags.flip_y,
               "exchange upper and lower views, which changes the sign of vertical disparities");
}

using info::file_kind, info::FileKind, info::other_kind_error;

void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views) {
  const OptionGroup group(app, kLightFieldOptions);
  if (has_views) {
    app.add_option("--views", flags.read.views_y.count, "number of central views to read per axis; 0 = all")
        ->check(whole_number(0, 65535));
  }
  app.add_option("--step", flags.read.views_y.step, "read every N-th view, which multiplies the disparity by N")
      ->check(whole_number(1, 65535));
  app.add_option("--white", flags.read.white, "stored value that is white, e.g. 255; default: the largest of the type")
      ->check(positive_number());
  app.add_option("--view-columns", flags.read.view_columns,
                 "number of views in a row of the grid, if views are numbered consecutively (input_Cam000.png ...); "
                 "default: detected")
      ->check(whole_number(1, 10000));
  app.add_option(
         "--lenslet-views", flags.read.lenslet_views,
         "number of views per axis in one picture that holds all views: a lenslet mosaic, or an Hr_SAI_y patch; "
         "default: as its name or content states")
      ->check(whole_number(1, 1000));
}

lightfield::ReadOptions read_options(const LightFieldFlags& flags) {
  lightfield::ReadOptions options = flags.read;
  options.views_x = options.views_y;
  options.orientation = flags.orientation.value();
  return options;
}

lightfield::ReadOptions unchanged_options(const LightFieldFlags& flags) {
  lightfield::ReadOptions options = read_options(flags);
  options.colour = true;
  options.range = lightfield::RangePolicy::kKeep;
  return options;
}

Result<lightfield::LightField> read_with_progress(const fs::path& path, const lightfield::ReadOptions& options,
                                                  bool is_quiet) {
  ProgressBar bar("read " + path.filename().string(), is_quiet);
  bar.update(0, 1);
  return lightfield::read_light_field(path, options, bar.callback());
}

Result<lightfield::LightField> load_scene(const fs::path& path, const SceneOptions& options, bool is_quiet) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  // A file of no other kind is taken for a recording; reading it gives a better error.
  if (kind != FileKind::kLightField && kind != FileKind::kRecording) {
    return other_kind_error(path, kind, "a light field");
  }
  lightfield::ReadOptions read = read_options(options.flags);
  read.views_y.count = options.views_y;
  read.views_x.count = options.views_x;
  read.colour = options.colour;
  return read_with_progress(path, read, is_quiet);
}

Result<lightfield::LightField> load_to_show(const fs::path& path, const LightFieldFlags& flags, bool is_quiet,
                                            const std::vector<float>& disparities) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField) return other_kind_error(path, kind, "a light field");
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField light_field,
                        read_with_progress(path, unchanged_options(flags), is_quiet));
  const auto [width, height] = std::pair(light_field.shape().width, light_field.shape().height);
  for (const float disparity : disparities) {
    if (std::abs(disparity) < static_cast<float>(std::max(width, height))) continue;
    return fail(ErrorCode::kInvalidValue, path, "a disparity of ", disparity, " px per view step exceeds the image of ",
                width, "x", height, " px; use a disparity closer to 0");
  }
  return light_field;
}

}  // namespace e2lf::program
