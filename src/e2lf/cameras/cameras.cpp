// SPDX-License-Identifier: MIT
#include "e2lf/cameras/cameras.h"

#include <cstdlib>
#include <mutex>

namespace e2lf::cameras {
namespace {

using recordings::CameraPlugin;

std::vector<CameraPlugin> plugins_of_environment() {
  const char* const places = std::getenv("E2LF_CAMERA_PLUGINS");
  return places == nullptr ? std::vector<CameraPlugin>() : recordings::load_camera_plugins(places);
}

}  // namespace

void add_cameras() {
  static std::once_flag once;
  std::call_once(once, [] {
    for (const CameraPlugin& plugin : {
             CameraPlugin{"replay",
                          "a recording at the speed it was recorded with; ADDRESS is its path, or "
                          "PATH?speed=S&repeat=N",
                          recordings::open_replay_camera},
             CameraPlugin{"pipe", "standard input; ADDRESS is the path of a named pipe or nothing",
                          recordings::open_pipe_camera},
             CameraPlugin{"tcp", "a sender of recording bytes; ADDRESS is 127.0.0.1:PORT", recordings::open_tcp_camera},
             CameraPlugin{"v4l2", "an event sensor behind a Linux driver; ADDRESS is its device, e.g. video0",
                          recordings::open_v4l2_camera, recordings::list_v4l2_cameras},
#ifdef E2LF_HAVE_METAVISION_HAL
             CameraPlugin{"metavision", "a camera of the vendor's open HAL; ADDRESS is a serial number or nothing",
                          recordings::open_metavision_camera, recordings::list_metavision_cameras},
#endif
         }) {
      recordings::add_camera_plugin(plugin);
    }
    recordings::add_camera_plugins(plugins_of_environment);
  });
}

}  // namespace e2lf::cameras
