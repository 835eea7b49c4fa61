// SPDX-License-Identifier: MIT
// Finds cameras by their names; declared in camera.h.
#include <algorithm>
#include <mutex>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {
namespace {

constexpr std::string_view kCameraScheme = "camera://", kReplay = "replay:", kTcp = "tcp://";

struct Registry {
  std::mutex mutex;
  std::vector<CameraPlugin> plugins;
  std::vector<std::function<std::vector<CameraPlugin>()>> loaders;  ///< not called yet
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

/// Adds the plugins that were not loaded yet. The mutex of the registry must be locked.
void load_plugins(Registry& known) {
  for (const auto& load : std::exchange(known.loaders, {})) {
    for (CameraPlugin& plugin : load()) {
      if (find_known(known.plugins, plugin.name) == nullptr) {
        known.plugins.push_back(std::move(plugin));
      } else {
        log_warning(cat("a camera plugin is left out: there is another one with the name ", plugin.name));
      }
    }
  }
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

Result<CameraPlugin> find_camera_plugin(const std::string& name, const std::string& location) {
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

void add_camera_plugins(std::function<std::vector<CameraPlugin>()> load) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  registry().loaders.push_back(std::move(load));
}

bool is_camera_name(const std::string& name) {
  return name.starts_with(kCameraScheme) || name.starts_with(kReplay) || name.starts_with(kTcp);
}

size_t replay_path_size(const std::string& address) {
  std::error_code error;
  return std::filesystem::exists(address, error) ? address.size() : std::min(address.rfind('?'), address.size());
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
  E2LF_ASSIGN_OR_RETURN(const CameraPlugin plugin, find_camera_plugin(parsed.plugin, name));
  E2LF_ASSIGN_OR_RETURN(CameraPtr camera, plugin.open(parsed.address));
  return start_camera_source(std::move(camera), name, setup);
}

Result<ReaderPtr> open_camera(const std::string& name, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(SourcePtr source, open_camera_bytes(name, options.camera));
  return open_recording(std::move(source), options);
}

}  // namespace e2lf::recordings
