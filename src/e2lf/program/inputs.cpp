// SPDX-License-Identifier: MIT
#include "e2lf/program/inputs.h"

#include <type_traits>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/program/option_values.h"

namespace e2lf::program {
namespace fs = std::filesystem;
using pipeline::KnownCodes;
namespace {

/// Declares an option for a file, or for several, by path or bundled name. For missing files, throws the parser's
/// exception.
template <typename Paths>
CLI::Option* add_named(CLI::App& app, const std::string& flags, const BundledKind& kind, const char* type, Paths& paths,
                       const std::string& help) {
  const auto take = [&paths, &kind](const CLI::results_t& names) {
    paths.clear();
    for (const std::string& name : names) {
      auto path = find_file_or_bundled(kind, name);
      if (!path) throw CLI::FileError(path.error().text());
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
  E2LF_ASSIGN_OR_RETURN(const fs::path path, find_camera(name));
  record.add_input(path);
  E2LF_ASSIGN_OR_RETURN(capture::SensorProfile camera, capture::read_camera(path));
  record.note("camera", capture::to_json(camera));
  return camera;
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
  const fs::path folder = source.model.has_parent_path() ? source.model.parent_path() : ".";
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::decode_model(bytes, source.model.string(), folder));
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

}  // namespace e2lf::program
