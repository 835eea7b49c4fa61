// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/open_named_recording.h"

#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

Result<std::unique_ptr<RecordingReader>> open_named_recording(const std::string& name, const OpenOptions& options) {
  if (is_camera_name(name)) return open_camera(name, options);
  struct stat input {};
  const bool is_pipe =
      name == "-" && ::fstat(STDIN_FILENO, &input) == 0 && (S_ISFIFO(input.st_mode) || S_ISSOCK(input.st_mode));
  return is_pipe ? open_camera("camera://pipe", options) : open_recording(std::filesystem::path(name), options);
}

}  // namespace e2lf::recordings
