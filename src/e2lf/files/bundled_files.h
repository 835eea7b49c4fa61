// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Returns a file that comes with e2lf, such as "models/e2lf-n4.safetensors": of share/e2lf in the nearest folder above
/// the running program or above the Python module, or of the source tree. Nothing when none of them has it.
[[nodiscard]] std::optional<std::filesystem::path> bundled_file(const std::string& path);

/// The model of verbs that need one and are given none.
[[nodiscard]] std::optional<std::filesystem::path> bundled_model();

/// Files that come with e2lf and can be given by their name alone; what such a file, and any other one, is called.
struct BundledKind {
  const char *folder, *extension, *bundled, *any;
};
inline constexpr BundledKind kBundledModels{"models", ".safetensors", "model", "model file"};
inline constexpr BundledKind kBundledCameras{"cameras", ".json", "camera", "camera file"};
/// Patterns: a bundled model stands for its own.
inline constexpr BundledKind kBundledCodes{"models", ".safetensors", "model", "file of patterns, or model"};

/// The names of the bundled files of a kind, without their extension, sorted.
[[nodiscard]] std::vector<std::string> bundled_names(const BundledKind& kind);

/// The bundled file of a name, with or without its extension, alone or as documents write it, behind the folder of its
/// kind ("models/e2lf-n4.safetensors"). Nothing for another name.
[[nodiscard]] std::optional<std::filesystem::path> bundled_file_named(const BundledKind& kind, const std::string& name);

/// The name of a bundled file of a kind; any other path as it is.
[[nodiscard]] std::string shown_name(const BundledKind& kind, const std::filesystem::path& path);

/// Returns what `name` names: a file of exactly this name, else the bundled file of this name, else any other thing of
/// this name (a folder, a pipe). Fails with kNotFound, naming the bundled ones.
[[nodiscard]] Result<std::filesystem::path> find_file_or_bundled(const BundledKind& kind, const std::string& name);

}  // namespace e2lf
