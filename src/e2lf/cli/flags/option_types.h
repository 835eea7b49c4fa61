// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

/// The placeholders of option values in --help. They also identify the options that name files: --config resolves their
/// values (recorded_paths.h), and completion offers bundled files for them.
namespace e2lf::cli {

inline constexpr char kPathType[] = "PATH", kModelType[] = "MODEL", kCodesType[] = "PATTERNS", kCameraType[] = "CAMERA";
/// For verbs that accept any file or folder.
inline constexpr char kThingType[] = "PATH|MODEL";

}  // namespace e2lf::cli

/// Names the type of all path options; CLI11 would call it TEXT.
template <>
constexpr const char* CLI::detail::type_name<std::filesystem::path>() {
  return e2lf::cli::kPathType;
}
