// SPDX-License-Identifier: MIT
#include "e2lf/program/inputs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/program/option_values.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::program {
namespace fs = std::filesystem;
using pipeline::KnownCodes;
namespace {

/// Throws the parser's exception for missing files.
fs::path find_named(const BundledKind& kind, const std::string& name) {
  auto path = find_file_or_bundled(kind, name);
  if (!path) throw CLI::FileError(path.error().text());
  return *std::move(path);
}

}  // namespace

CLI::Option* add_model_option(CLI::App& app, const std::string& flags, fs::path& model, const std::string& help) {
  const auto take = [&model](const CLI::results_t& names) {
    model = find_named(kBundledModels, names.back());
    return true;
  };
  return app.add_option(flags, take, help)->type_name(kModelType);
}

CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::vector<fs::path>& models,
                              const std::string& help) {
  const auto take = [&models](const CLI::results_t& names) {
    models.clear();
    for (const std::string& name : names) models.push_back(find_named(kBundledModels, name));
    return true;
  };
  return app.add_option(flags, take, help)->type_name(kModelType)->expected(1, CLI::detail::expected_max_vector_size);
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
  E2LF_ASSIGN_OR_RETURN(const fs::path path, find_camera(name));
  record.add_input(path);
  E2LF_ASSIGN_OR_RETURN(capture::SensorProfile camera, capture::read_camera(path));
  record.note("camera", capture::to_json(camera));
  return camera;
}

CLI::Option* add_codes_option(CLI::App& app, fs::path& codes, const std::string& help) {
  const auto take = [&codes](const CLI::results_t& names) {
    codes = find_named(kBundledCodes, names.back());
    return true;
  };
  return app.add_option("--codes", take, help)->type_name(kCodesType);
}

void add_codes_options(CLI::App& app, CodesSource& source) {
  add_model_option(app, "-m,--model", source.model,
                   "model file, or the name of a bundled model: its patterns and sensor constants");
  add_codes_option(app, source.codes,
                   "aperture patterns (.json, .npy, .npz, or a model); default: those in the file of the events, or "
                   "else those of the model, or else those of e2lf-n4");
}

Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record) {
  if (source.model.empty()) return std::optional<model::Model>();
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(source.model));
  record.add_input(source.model, bytes);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::decode_model(bytes, source.model.string()));
  return std::optional(std::move(model));
}

void note_named_codes(const CodesSource& source, const std::optional<capture::Codes>& codes,
                      const std::optional<capture::Codes>& of_events, RunRecord& record) {
  if (!codes) return;
  record.add_input(source.codes);
  if (!of_events || *codes == *of_events) return;
  log_warning(cat("the patterns of ", source.codes.string(), " differ from those in the file of the events; ",
                  "using those of --codes"));
}

Result<std::optional<KnownCodes>> find_codes(const CodesSource& source, const std::optional<model::Model>& model,
                                             const std::optional<capture::Codes>& of_events, RunRecord& record) {
  std::optional<capture::Codes> named;
  if (!source.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(named, pipeline::read_patterns(source.codes));
  }
  note_named_codes(source, named, of_events, record);
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

using info::file_kind, info::FileKind, info::other_kind_error;

void add_orientation_options(CLI::App& app, OrientationFlags& flags) {
  const auto flag = [&](const char* name, bool& value, const char* help) {
    app.add_flag(name, value, help)->group(kOrientationOptions);
  };
  flag("--turn-views", flags.turn_views,
       "turn the grid of views by 180 degrees in addition to what files state, which changes the sign of every "
       "disparity");
  flag("--flip-x", flags.flip_x, "exchange left and right views, which changes the sign of horizontal disparities");
  flag("--flip-y", flags.flip_y, "exchange upper and lower views, which changes the sign of vertical disparities");
}

void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views) {
  const char* const group = kLightFieldOptions;
  if (has_views) {
    app.add_option("--views", flags.views, "number of central views to read per axis; 0 = all")
        ->check(whole_number(0, 65535))
        ->group(group);
  }
  app.add_option("--step", flags.step, "read every N-th view, which multiplies the disparity by N")
      ->check(whole_number(1, 65535))
      ->group(group);
  app.add_option("--white", flags.white, "stored value that is white, e.g. 255; default: the largest of the type")
      ->check(positive_number())
      ->group(group);
  app.add_option("--view-columns", flags.view_columns,
                 "number of views in a row of the grid, if views are numbered consecutively (input_Cam000.png ...); "
                 "default: detected")
      ->check(whole_number(1, 10000))
      ->group(group);
  app.add_option("--lenslet-views", flags.lenslet_views,
                 "number of views per axis below a microlens, for mosaics that do not state it")
      ->check(whole_number(1, 1000))
      ->group(group);
}

lightfield::ReadOptions read_options(const LightFieldFlags& flags) {
  lightfield::ReadOptions options;
  for (lightfield::AxisViews* views : {&options.views_y, &options.views_x}) {
    views->count = flags.views;
    views->step = flags.step;
  }
  options.white = flags.white;
  options.view_columns = flags.view_columns;
  options.lenslet_views = flags.lenslet_views;
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

Error no_light_field_error(const fs::path& path) {
  const auto kind = file_kind(path);
  if (!kind) return kind.error();
  return other_kind_error(path, *kind, "a light field");
}

Result<lightfield::LightField> load_to_show(const fs::path& path, const LightFieldFlags& flags, bool is_quiet,
                                            const std::vector<float>& disparities) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField) return no_light_field_error(path);
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
