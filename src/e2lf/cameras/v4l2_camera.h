// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

/// The system calls of a V4L2 camera, which tests replace. Like those of the C library, they return -1 and set errno on
/// failure.
class V4l2System {
 public:
  virtual ~V4l2System() = default;
  virtual int open(const std::string& path);
  virtual int close(int descriptor);
  virtual int control(int descriptor, unsigned long request, void* argument);  ///< ioctl()
  virtual void* map(size_t length, int descriptor, off_t offset);              ///< null on failure
  virtual void unmap(void* memory, size_t length);
  /// Waits for data. Returns 1 if they can be read, 0 after the timeout, and -1 if the device failed.
  virtual int wait(int descriptor, int timeout_ms);
};

/// Returns the devices of a folder that send events, by their file names ("video0").
[[nodiscard]] std::vector<std::string> find_v4l2_devices(V4l2System& system, const std::string& folder);

/// Creates the camera of open_v4l2_camera() (cameras.h), whose devices are in `folder`. `system` must outlive it.
[[nodiscard]] CameraPtr make_v4l2_camera(V4l2System& system, const std::string& folder, const std::string& address);

}  // namespace e2lf::recordings
