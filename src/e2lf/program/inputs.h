// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/model/model.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/program/outputs.h"

namespace e2lf::program {

/// Options that name models, patterns and cameras: by a path, or by the name of a bundled file with or without its
/// extension. A file with exactly this name takes precedence.

/// Declares an option or argument that takes a model. `model` is set to the path. If there is no such model,
/// Verb::run() lists the bundled ones.
CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::filesystem::path& model,
                              const std::string& help);
/// Declares the same for several models.
CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::vector<std::filesystem::path>& models,
                              const std::string& help);

/// Declares --codes: a file of patterns, a model, or the name of a bundled model.
CLI::Option* add_codes_option(CLI::App& app, std::filesystem::path& codes, const std::string& help);

/// Declares --camera.
void add_camera_option(CLI::App& app, std::string& camera, const std::string& help);

/// Returns the path of a camera file. Fails with kNotFound, listing the bundled cameras.
[[nodiscard]] Result<std::filesystem::path> find_camera(const std::string& name);

/// Reads the camera that --camera names and adds it to the record. Fails as find_camera() and capture::read_camera()
/// do.
[[nodiscard]] Result<capture::SensorProfile> load_camera(const std::string& name, RunRecord& record);

/// The sources of the aperture patterns of a verb: a model file, or a file of codes or another model.
struct CodesSource {
  std::filesystem::path model, codes;
};

/// Declares -m/--model and --codes.
void add_codes_options(CLI::App& app, CodesSource& source);

/// Reads the model if one was given, and adds its content to the record. Fails as read_model() does.
[[nodiscard]] Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record);

/// Returns the patterns of --codes, or else `of_events` (those in the file of the events), or else those of `model`, or
/// nothing if none of them exist. Warns if --codes and the file of the events differ.
[[nodiscard]] Result<std::optional<pipeline::KnownCodes>> find_codes(const CodesSource& source,
                                                                     const std::optional<model::Model>& model,
                                                                     const std::optional<capture::Codes>& of_events,
                                                                     RunRecord& record);

/// Reads the patterns of --codes, or else those of the model. If neither is given, uses those of the bundled model and
/// logs this, or the built-in ones if there is no bundled model. Fails with kNotFound if the model contains no
/// patterns.
[[nodiscard]] Result<pipeline::KnownCodes> load_codes(const CodesSource& source, RunRecord& record);

/// The flags that change the orientation of the views.
struct OrientationFlags {
  bool turn_views = false, flip_x = false, flip_y = false;

  /// Returns the combination of all flags that are set.
  [[nodiscard]] capture::Orientation value() const {
    return capture::Orientation{flip_x, flip_y} + (turn_views ? capture::kTurned : capture::Orientation{});
  }
  /// Returns the orientation that results from `recorded` and the flags, or nothing if neither is set.
  [[nodiscard]] std::optional<capture::Orientation> after(const std::optional<capture::Orientation>& recorded) const {
    if (value().is_upright()) return recorded;
    return recorded.value_or(capture::Orientation{}) + value();
  }
};

/// Declares --turn-views, --flip-x and --flip-y.
void add_orientation_options(CLI::App& app, OrientationFlags& flags);

/// The light fields that verbs read, and the options of how they are read.

/// The flags of verbs that read a light field.
struct LightFieldFlags {
  lightfield::ReadOptions read = {{.count = 0, .first = {}}, {}};  ///< views_y is for both axes; by default, all views
  OrientationFlags orientation = {};                               ///< replaces that of `read`
};

/// Declares --step, --white, --view-columns and --lenslet-views, and also --views if the verb can use any number of
/// views.
void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views);

[[nodiscard]] lightfield::ReadOptions read_options(const LightFieldFlags& flags);
/// The same for light fields that are shown or stored as they are: in colour, without clamping values to [0, 1].
[[nodiscard]] lightfield::ReadOptions unchanged_options(const LightFieldFlags& flags);

/// Reads a light field with read_light_field() and shows the progress.
[[nodiscard]] Result<lightfield::LightField> read_with_progress(const std::filesystem::path& path,
                                                                const lightfield::ReadOptions& options, bool is_quiet);

/// Options for reading a scene, which must have as many views as the patterns have cells.
struct SceneOptions {
  LightFieldFlags flags = {};       ///< the number of views in it is ignored
  size_t views_y = 8, views_x = 8;  ///< number of central views
  bool colour = false;              ///< whether to keep the colour; otherwise grey
};

/// Reads a light field of any supported format, with values in [0, 1]. Fails as read_light_field() does.
[[nodiscard]] Result<lightfield::LightField> load_scene(const std::filesystem::path& path, const SceneOptions& options,
                                                        bool is_quiet);

/// Reads one light field for rendering: all its views, in colour, without clamping values to [0, 1]. Fails with
/// kUnsupported if `path` is something else; for a folder of cycles the error asks for one of them. Fails with
/// kInvalidValue if one of `disparities` (px per view step), at which it will be rendered, shifts a view out of the
/// image.
[[nodiscard]] Result<lightfield::LightField> load_to_show(const std::filesystem::path& path,
                                                          const LightFieldFlags& flags, bool is_quiet,
                                                          const std::vector<float>& disparities = {});

}  // namespace e2lf::program
