// SPDX-License-Identifier: MIT
// Finds cameras by their names; declared in cameras.h.
#include <algorithm>
#include <cstdlib>
#include <mutex>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/live/cameras.h"

namespace e2lf::recordings {
namespace {

constexpr std::string_view kCameraScheme = "camera://", kReplay = "replay:", kTcp = "tcp://";

struct Registry {
  std::mutex mutex;
  bool has_loaded = false;  ///< whether those of E2LF_CAMERA_PLUGINS were loaded
  std::vector<CameraPlugin> plugins = {
      {"replay", "a recording at the speed it was recorded with; ADDRESS is its path, or PATH?speed=S&repeat=N",
       open_replay_camera},
      {"pipe", "standard input; ADDRESS is the path of a named pipe or nothing", open_pipe_camera},
      {"tcp", "a sender of recording bytes; ADDRESS is 127.0.0.1:PORT", open_tcp_camera},
      {"v4l2", "an event sensor behind a Linux driver; ADDRESS is its device, e.g. video0", open_v4l2_camera,
       list_v4l2_cameras},
#ifdef E2LF_HAVE_METAVISION_HAL
      {"metavision", "a camera of the vendor's open HAL; ADDRESS is a serial number or nothing", open_metavision_camera,
       list_metavision_cameras},
#endif
  };
};

Registry& registry() {
  static Registry instance;
  return instance;
}

struct CameraName {
  std::string plugin, address;
};

CameraName parse_name(const std::string& name) {
  if (name.starts_with(kReplay)) return {"replay", name.substr(kReplay.size())};
  if (name.starts_with(kTcp)) return {"tcp", name.substr(kTcp.size())};
  const std::string rest = name.substr(kCameraScheme.size());
  const size_t slash = std::min(rest.find('/'), rest.size());
  return {rest.substr(0, slash), slash < rest.size() ? rest.substr(slash + 1) : ""};
}

const CameraPlugin* find_known(const std::vector<CameraPlugin>& plugins, const std::string& name) {
  const auto found = std::find_if(plugins.begin(), plugins.end(), [&](const auto& one) { return one.name == name; });
  return found == plugins.end() ? nullptr : &*found;
}

/// Adds the plugins of E2LF_CAMERA_PLUGINS once. The mutex of the registry must be locked.
void load_plugins(Registry& known) {
  const char* const places = std::getenv("E2LF_CAMERA_PLUGINS");
  if (std::exchange(known.has_loaded, true) || places == nullptr) return;
  for (CameraPlugin& plugin : load_camera_plugins(places)) {
    if (find_known(known.plugins, plugin.name) == nullptr) {
      known.plugins.push_back(std::move(plugin));
    } else {
      log_warning(cat("a camera plugin is left out: there is another one with the name ", plugin.name));
    }
  }
}

/// Loads external plugins only if this build has none with this name.
Result<CameraPlugin> find_plugin(const std::string& name, const std::string& location) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  const std::vector<CameraPlugin>& plugins = registry().plugins;
  if (find_known(plugins, name) == nullptr) load_plugins(registry());
  if (const CameraPlugin* const found = find_known(plugins, name)) return *found;
  if (name == "metavision") {
    return Error{ErrorCode::kMissingDependency,
                 "this build does not contain the vendor's HAL; install it and build again", location};
  }
  std::vector<std::string> names;
  for (const CameraPlugin& plugin : plugins) names.push_back(plugin.name);
  return Error{ErrorCode::kNotFound,
               cat("there is no camera plugin \"", name, "\"; write camera://NAME with one of ", join(names),
                   ", or give the file of a plugin in E2LF_CAMERA_PLUGINS"),
               location};
}

}  // namespace

std::vector<CameraPlugin> camera_plugins() {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  load_plugins(registry());
  return registry().plugins;
}

void add_camera_plugin(const CameraPlugin& plugin) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  std::erase_if(registry().plugins, [&](const CameraPlugin& known) { return known.name == plugin.name; });
  registry().plugins.push_back(plugin);
}

bool is_camera_name(const std::string& name) {
  return name.starts_with(kCameraScheme) || name.starts_with(kReplay) || name.starts_with(kTcp);
}

std::filesystem::path path_of_camera(const std::string& name) {
  const CameraName parsed = parse_name(name);
  if (parsed.plugin == "replay") return parsed.address.substr(0, replay_path_size(parsed.address));
  return parsed.plugin == "pipe" ? parsed.address : "";
}

Result<void> Camera::set_up(const CameraSetup& setup) {
  if (setup == CameraSetup()) return {};
  return Error{ErrorCode::kUnsupported,
               "this input has no settings of a camera (trigger inputs, biases, event rate, regions, encoding); leave "
               "them out",
               ""};
}

Result<std::unique_ptr<LiveSource>> open_camera_bytes(const std::string& name, const CameraSetup& setup) {
  if (!is_camera_name(name)) {
    return Error{ErrorCode::kInvalidValue, "not a camera; write camera://NAME or camera://NAME/ADDRESS", name};
  }
  const CameraName parsed = parse_name(name);
  E2LF_ASSIGN_OR_RETURN(const CameraPlugin plugin, find_plugin(parsed.plugin, name));
  E2LF_ASSIGN_OR_RETURN(CameraPtr camera, plugin.open(parsed.address));
  return start_camera_source(std::move(camera), name, setup);
}

Result<ReaderPtr> open_camera(const std::string& name, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(SourcePtr source, open_camera_bytes(name, options.camera));
  return open_recording(std::move(source), options);
}

}  // namespace e2lf::recordings
