// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/open_named_recording.h"

#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/files/file.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

bool is_live_recording(const std::string& name) {
  return name == "-" || is_camera_name(name) || is_stream(name);
}

std::filesystem::path file_of_recording(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path path = name == "-"            ? fs::canonical("/proc/self/fd/0", error)
                        : is_camera_name(name) ? path_of_camera(name)
                                               : fs::path(name);
  return fs::is_regular_file(path, error) || fs::is_directory(path, error) ? path : fs::path();
}

Result<std::unique_ptr<LiveSource>> open_live_bytes(const std::string& name, const CameraSetup& setup) {
  if (is_camera_name(name)) return open_camera_bytes(name, setup);
  if (name == "-") return open_camera_bytes("camera://pipe", setup);
  if (!is_stream(name)) {
    return Error{
        ErrorCode::kInvalidValue,
        "this is not a live input; give a camera (camera://NAME), tcp://ADDRESS:PORT, replay:FILE, a named pipe "
        "or -",
        name};
  }
  E2LF_ASSIGN_OR_RETURN(const CameraPlugin pipes, find_camera_plugin("pipe", name));
  E2LF_ASSIGN_OR_RETURN(CameraPtr camera, pipes.open(name));
  return start_camera_source(std::move(camera), name, setup);
}

Result<ReaderPtr> open_named_recording(const std::string& name, const OpenOptions& options) {
  struct stat input {};
  const bool is_pipe =
      name == "-" && ::fstat(STDIN_FILENO, &input) == 0 && (S_ISFIFO(input.st_mode) || S_ISSOCK(input.st_mode));
  if (is_pipe || (name != "-" && is_live_recording(name))) {
    E2LF_ASSIGN_OR_RETURN(SourcePtr source, open_live_bytes(name, options.camera));
    return open_recording(std::move(source), options);
  }
  if (options.camera != CameraSetup()) {
    return Error{ErrorCode::kInvalidValue, "camera settings do not apply to a file; leave them out", name};
  }
  return open_recording(std::filesystem::path(name), options);
}

}  // namespace e2lf::recordings
