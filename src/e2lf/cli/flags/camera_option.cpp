// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/camera_option.h"

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_types.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

Result<fs::path> find_camera(const std::string& name) {
  return find_file_or_bundled(kBundledCameras, name);
}

void add_camera_option(CLI::App& app, std::string& camera, const std::string& help) {
  app.add_option("--camera", camera,
                 cat("camera file (JSON) or one of ", join(bundled_names(kBundledCameras)), ": ", help))
      ->type_name(kCameraType);
}

Result<capture::SensorProfile> load_camera(const std::string& name, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const fs::path path, find_camera(name));
  record.add_input(path);
  E2LF_ASSIGN_OR_RETURN(capture::SensorProfile camera, capture::read_camera(path));
  record.note("camera", capture::to_json(camera));
  return camera;
}

}  // namespace e2lf::cli
