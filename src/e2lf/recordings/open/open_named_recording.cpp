// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/open_named_recording.h"

#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/files/is_stream.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/live/camera_source.h"
#include "e2lf/recordings/live/cameras.h"

namespace e2lf::recordings {

bool is_live_recording(const std::string& name) {
  return name == "-" || is_camera_name(name) || is_stream(name);
}

Result<std::unique_ptr<RecordingReader>> open_named_recording(const std::string& name, const OpenOptions& options) {
  if (is_camera_name(name)) return open_camera(name, options);
  if (is_stream(name)) {
    E2LF_ASSIGN_OR_RETURN(std::unique_ptr<Camera> camera, open_pipe_camera(name));
    E2LF_ASSIGN_OR_RETURN(std::unique_ptr<ByteSource> source, start_camera_source(std::move(camera), name));
    return open_recording(std::move(source), options);
  }
  struct stat input {};
  const bool is_pipe =
      name == "-" && ::fstat(STDIN_FILENO, &input) == 0 && (S_ISFIFO(input.st_mode) || S_ISSOCK(input.st_mode));
  return is_pipe ? open_camera("camera://pipe", options) : open_recording(std::filesystem::path(name), options);
}

}  // namespace e2lf::recordings
