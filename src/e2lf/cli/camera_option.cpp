// SPDX-License-Identifier: MIT
#include "e2lf/cli/camera_option.h"

#include <algorithm>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/cli/bundled_files.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> bundled_cameras() {
  std::vector<std::string> names;
  const auto folder = bundled_file("cameras");
  std::error_code error;
  if (!folder) return names;
  for (fs::directory_iterator entry(*folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".json") names.push_back(entry->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

Result<fs::path> find_camera(const std::string& name) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return fs::path(name);
  const bool is_name = name.find('/') == std::string::npos;
  if (const auto bundled = bundled_file("cameras/" + name + ".json"); is_name && bundled) return *bundled;
  return Error{ErrorCode::kNotFound,
               cat("there is no such camera file; give one, or a bundled camera: ", join(bundled_cameras())), name};
}

void add_camera_option(CLI::App& app, std::string& camera, const std::string& help) {
  app.add_option("--camera", camera, cat("camera file (JSON) or one of ", join(bundled_cameras()), ": ", help));
}

Result<capture::Camera> load_camera(const std::string& name, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const fs::path path, find_camera(name));
  record.add_input(path);
  E2LF_ASSIGN_OR_RETURN(capture::Camera camera, capture::read_camera(path));
  record.note("camera", capture::to_json(camera));
  return camera;
}

}  // namespace e2lf::cli
