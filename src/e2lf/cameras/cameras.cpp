// SPDX-License-Identifier: MIT
#include "e2lf/cameras/cameras.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <mutex>
#include <sstream>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/io/header_text.h"
#include "e2lf/recordings/live/camera_plugin.h"

namespace e2lf::cameras {
namespace fs = std::filesystem;
namespace {

/// The buffer for the error message of a plugin.
class PluginError {
 public:
  char* buffer() {
    text_.fill('\0');
    return text_.data();
  }
  [[nodiscard]] Error error(ErrorCode code, const std::string& name) const {
    const std::string message(text_.data(), std::find(text_.begin(), text_.end() - 1, '\0'));
    return {code,
            message.empty() ? "the plugin failed without a message; report this to its author" : header_text(message),
            name};
  }

 private:
  std::array<char, E2LF_CAMERA_ERROR_SIZE> text_{};
};

class PluginCamera final : public Camera {
 public:
  PluginCamera(const e2lf_camera_functions& functions, e2lf_camera* camera, std::string name)
      : functions_(functions), camera_(camera), name_(std::move(name)) {}
  ~PluginCamera() override { functions_.close(camera_); }

  Result<void> set_up(const CameraSetup& setup) override {
    if (!setup.encoding.empty()) E2LF_RETURN_IF_ERROR(set("encoding", setup.encoding));
    if (!setup.biases.empty()) E2LF_RETURN_IF_ERROR(load_biases(setup.biases));
    if (setup.max_events_per_s) E2LF_RETURN_IF_ERROR(set("max-event-rate", cat(*setup.max_events_per_s)));
    std::vector<std::string> regions;
    for (const SensorRegion& one : setup.regions) {
      regions.push_back(cat(one.x, ",", one.y, ",", one.width, ",", one.height));
    }
    if (!regions.empty()) E2LF_RETURN_IF_ERROR(set("roi", join(regions, " ")));
    if (setup.switches_filters_off) E2LF_RETURN_IF_ERROR(set("sensor-filters", "off"));
    return switch_on_triggers(setup.trigger_channels);
  }

  Result<void> start() override {
    E2LF_RETURN_IF_ERROR(checked(functions_.start(camera_, error_.buffer()), ErrorCode::kIo));
    if (functions_.save_biases == nullptr) return {};
    const char* const biases = functions_.save_biases(camera_, error_.buffer());
    if (biases == nullptr) return error_.error(ErrorCode::kIo, name_);
    biases_ = biases;
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes.clear();
    lost_ = 0;
    while (bytes.empty()) {
      if (is_stopped_ && Clock::now() > stop_time_.load() + kLongestDrain) return false;
      e2lf_camera_buffer buffer{};
      const e2lf_camera_state state = functions_.next(camera_, &buffer, error_.buffer());
      if (state == E2LF_CAMERA_ENDED) return false;
      if (state != E2LF_CAMERA_RUNS) return error_.error(ErrorCode::kIo, name_);
      if (buffer.size > 0 && buffer.bytes == nullptr) {
        return fail(ErrorCode::kIo, name_, "the plugin returned a buffer without memory; report this to its author");
      }
      lost_ += buffer.lost;
      if (buffer.size > 0) bytes.assign(buffer.bytes, buffer.bytes + buffer.size);
    }
    return true;
  }

  uint64_t lost_buffers() override { return lost_; }

  void stop() override {
    stop_time_ = Clock::now();
    if (!is_stopped_.exchange(true)) functions_.stop(camera_);
  }

  std::string bias_file_text() const override { return biases_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kLongestDrain = std::chrono::seconds(1);  ///< because a camera continues to send

  [[nodiscard]] Error has_no(const char* what) const {
    return fail(ErrorCode::kUnsupported, name_, "the camera has no ", what, "; leave the option out");
  }

  [[nodiscard]] Result<void> checked(int result, ErrorCode code = ErrorCode::kInvalidValue) const {
    if (result < 0) return error_.error(code, name_);
    return {};
  }

  Result<void> set(const char* setting, const std::string& value) {
    if (functions_.set == nullptr) return has_no(setting);
    return checked(functions_.set(camera_, setting, value.c_str(), error_.buffer()));
  }

  Result<void> load_biases(const fs::path& file) {
    if (functions_.load_biases == nullptr) return has_no("biases");
    constexpr size_t kMostBytes = size_t{1} << 20;
    E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_head(file, kMostBytes));
    const std::string text(bytes.begin(), bytes.end());
    return checked(functions_.load_biases(camera_, text.c_str(), error_.buffer()));
  }

  Result<void> switch_on_triggers(const std::vector<std::string>& inputs) {
    if (inputs == std::vector<std::string>{"none"}) return {};
    if (functions_.triggers_on == nullptr) return inputs.empty() ? Result<void>() : has_no("trigger inputs");
    std::vector<const char*> names;
    for (const std::string& input : inputs) names.push_back(input.c_str());
    return checked(functions_.triggers_on(camera_, names.data(), names.size(), error_.buffer()));
  }

  const e2lf_camera_functions& functions_;
  e2lf_camera* camera_;
  std::string name_, biases_;
  PluginError error_;
  uint64_t lost_ = 0;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<Clock::time_point> stop_time_;
};

Result<std::vector<std::string>> list_cameras_of(const e2lf_camera_functions& functions) {
  std::vector<std::string> addresses;
  const auto add = [](void* list, const char* address) {
    if (address != nullptr) static_cast<std::vector<std::string>*>(list)->push_back(header_text(address));
  };
  PluginError error;
  if (functions.list(add, &addresses, error.buffer()) < 0) {
    return error.error(ErrorCode::kIo, cat("camera://", functions.name));
  }
  return addresses;
}

bool is_plugin_name(const char* name) {
  if (name == nullptr || *name == '\0') return false;
  return std::string_view(name).find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") == std::string_view::npos;
}

/// Returns the plugin with these functions, which must be valid until the process ends. Fails with kUnsupported
/// (another version) and kFormat (a missing function, or an invalid name).
Result<CameraPlugin> plugin_of_functions(const e2lf_camera_functions* functions, const std::string& location) {
  if (functions == nullptr) return fail(ErrorCode::kFormat, location, "the camera plugin returns no functions");
  if (functions->version != E2LF_CAMERA_PLUGIN_VERSION) {
    return fail(ErrorCode::kUnsupported, location, "the camera plugin has version ", functions->version,
                " of the interface, and this program has ", E2LF_CAMERA_PLUGIN_VERSION,
                "; build it again with this camera_plugin.h");
  }
  if (!is_plugin_name(functions->name)) {
    return fail(ErrorCode::kFormat, location,
                "the name of a camera plugin consists of lower-case letters, digits, - and _");
  }
  if (functions->open == nullptr || functions->close == nullptr || functions->start == nullptr ||
      functions->next == nullptr || functions->stop == nullptr) {
    return fail(ErrorCode::kFormat, location, "the camera plugin lacks one of open, close, start, next and stop");
  }
  CameraPlugin plugin{functions->name, functions->description == nullptr ? "" : header_text(functions->description)};
  plugin.open = [functions](const std::string& address) -> Result<CameraPtr> {
    const std::string name = cat("camera://", functions->name, address.empty() ? "" : "/", address);
    PluginError error;
    e2lf_camera* const opened = functions->open(address.c_str(), error.buffer());
    if (opened == nullptr) return error.error(ErrorCode::kNotFound, name);
    return CameraPtr(std::make_unique<PluginCamera>(*functions, opened, name));
  };
  if (functions->list != nullptr) plugin.list = [functions] { return list_cameras_of(*functions); };
  return plugin;
}

Result<CameraPlugin> load_plugin(const fs::path& file) {
  // Libraries stay loaded, because their threads and texts may be in use until the process ends.
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const reason = ::dlerror();
    return fail(ErrorCode::kIo, file, "cannot be loaded (", reason == nullptr ? "" : header_text(reason), ")");
  }
  const auto function = reinterpret_cast<e2lf_camera_plugin_function>(::dlsym(library, E2LF_CAMERA_PLUGIN_FUNCTION));
  if (function == nullptr) {
    return fail(ErrorCode::kFormat, file, "is not a camera plugin: it does not export ", E2LF_CAMERA_PLUGIN_FUNCTION);
  }
  return plugin_of_functions(function(), file.string());
}

/// Returns the files at a place. A place that does not exist fails when it is loaded.
std::vector<fs::path> plugin_files(const fs::path& place) {
  std::error_code error;
  if (!fs::is_directory(place, error)) return {fs::absolute(place, error)};  // dlopen() would search for a bare name
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(place, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".so") files.push_back(fs::absolute(entry->path(), error));
  }
  if (error) log_warning(cat("the folder of camera plugins ", place.string(), " cannot be read: ", error.message()));
  std::sort(files.begin(), files.end());
  return files;
}

/// Loads the plugins of E2LF_CAMERA_PLUGINS: files and folders, separated by colons; of a folder, all .so files in the
/// order of their names. Plugins that cannot be loaded are left out with a warning.
std::vector<CameraPlugin> load_camera_plugins() {
  const char* const named = std::getenv("E2LF_CAMERA_PLUGINS");
  std::istringstream places(named == nullptr ? "" : named);
  std::vector<CameraPlugin> plugins;
  for (std::string place; std::getline(places, place, ':');) {
    if (place.empty()) continue;
    for (const fs::path& file : plugin_files(place)) {
      auto plugin = load_plugin(file);
      if (plugin) plugins.push_back(std::move(*plugin));
      if (!plugin) log_warning(cat("a camera plugin is left out: ", plugin.error().text()));
    }
  }
  return plugins;
}

}  // namespace

Error unopened_error(const std::string& address, const std::vector<std::string>& listed) {
  const std::string location = "camera://metavision" + (address.empty() ? "" : "/" + address);
  if (listed.empty()) {
    return fail(
        ErrorCode::kNotFound, location,
        "no camera is connected; check its cable and power, the vendor's udev rules, in a container the access to "
        "/dev/bus/usb, and that MV_HAL_PLUGIN_PATH names the folder of the HAL's plugins");
  }
  const auto is_requested = [&address](const std::string& name) {
    return address.empty() || name == address || name.ends_with(":" + address);
  };
  if (std::none_of(listed.begin(), listed.end(), is_requested)) {
    return fail(ErrorCode::kNotFound, location, "there is no camera ", address, "; those connected are ", join(listed));
  }
  return fail(ErrorCode::kIo, location,
              "the camera is busy, or its USB device cannot be opened; end other programs that use it, and check its "
              "permissions "
              "(install the vendor's udev rules)");
}

void add_cameras() {
  static std::once_flag once;
  std::call_once(once, [] {
    for (const CameraPlugin& plugin : {
             CameraPlugin{"replay",
                          "a recording at the speed it was recorded with; ADDRESS is its path, or "
                          "PATH?speed=S&repeat=N",
                          open_replay_camera},
             CameraPlugin{"pipe", "standard input; ADDRESS is the path of a named pipe or nothing", open_pipe_camera},
             CameraPlugin{"tcp", "a sender of recording bytes; ADDRESS is 127.0.0.1:PORT", open_tcp_camera},
#ifdef E2LF_HAVE_METAVISION_HAL
             CameraPlugin{"metavision", "a camera of the vendor's open HAL; ADDRESS is a serial number or nothing",
                          open_metavision_camera, list_metavision_cameras},
#endif
         }) {
      add_camera_plugin(plugin);
    }
    add_camera_plugins(load_camera_plugins);
  });
}

}  // namespace e2lf::cameras
