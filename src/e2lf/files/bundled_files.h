// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Returns the path of a file that is distributed with e2lf, such as "models/e2lf-n4.safetensors", or nothing if it
/// does not exist. It is searched in the folder of models that the environment variable E2LF_MODELS names and beside
/// it, in share/e2lf of the folders above the program or the shared library that contains e2lf, nearest first, in the
/// folders of add_data_folder(), and in share/e2lf of the prefix for which e2lf was built.
[[nodiscard]] std::optional<std::filesystem::path> bundled_file(const std::string& path);

/// Adds a folder with the folders "models" and "cameras". Any quotes around the path are removed.
bool add_data_folder(std::string path);

// An installed package of static libraries passes its folder to the programs that are compiled with it.
#ifdef E2LF_DATA_FOLDER
#pragma push_macro("linux")
#pragma push_macro("unix")
#undef linux  // macros of GNU dialects, which a path of pkg-config without quotes may contain
#undef unix
#define E2LF_TEXT_OF(...) #__VA_ARGS__
#define E2LF_TEXT(...) E2LF_TEXT_OF(__VA_ARGS__)
inline const bool kHasDataFolder = add_data_folder(E2LF_TEXT(E2LF_DATA_FOLDER));
#undef E2LF_TEXT
#undef E2LF_TEXT_OF
#pragma pop_macro("unix")
#pragma pop_macro("linux")
#endif

/// Returns the model that verbs use if none is given, or nothing if it is missing.
[[nodiscard]] std::optional<std::filesystem::path> bundled_model();

/// A kind of files that are distributed with e2lf and can be given by name: folder, extension, and the terms for a
/// bundled and for any file of this kind in messages.
struct BundledKind {
  const char *folder, *extension, *bundled, *any;
};
inline constexpr BundledKind kBundledModels{"models", ".safetensors", "model", "model file"};
inline constexpr BundledKind kBundledCameras{"cameras", ".json", "camera", "camera file"};
/// Patterns; a bundled model denotes its patterns.
inline constexpr BundledKind kBundledCodes{"models", ".safetensors", "model", "file of patterns, or model"};

/// Returns the names of the bundled files of a kind, without extension, sorted.
[[nodiscard]] std::vector<std::string> bundled_names(const BundledKind& kind);

/// Returns the bundled file with this name, which may include the extension and the folder of its kind
/// ("models/e2lf-n4.safetensors"). Returns nothing for any other name.
[[nodiscard]] std::optional<std::filesystem::path> bundled_file_named(const BundledKind& kind, const std::string& name);

/// Returns the name of a bundled file of a kind; any other path is returned unchanged.
[[nodiscard]] std::string shown_name(const BundledKind& kind, const std::filesystem::path& path);

/// Returns the path that `name` denotes: a file with exactly this name, or else the bundled file, or else a folder or
/// pipe with this name. Fails with kNotFound, listing the bundled files.
[[nodiscard]] Result<std::filesystem::path> find_file_or_bundled(const BundledKind& kind, const std::string& name);

}  // namespace e2lf
