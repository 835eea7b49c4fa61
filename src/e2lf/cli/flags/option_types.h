// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

/// What stands for an option's value in --help. It also tells the options that name files: --config resolves their
/// values (recorded_paths.h), and completion offers bundled files for them.
namespace e2lf::cli {

inline constexpr char kPathType[] = "PATH", kModelType[] = "MODEL", kCodesType[] = "PATTERNS", kCameraType[] = "CAMERA";
/// Of verbs that take any file or folder.
inline constexpr char kThingType[] = "PATH|MODEL";

}  // namespace e2lf::cli

/// Every option that holds a path says so; the library calls them TEXT otherwise.
template <>
constexpr const char* CLI::detail::type_name<std::filesystem::path>() {
  return e2lf::cli::kPathType;
}
