// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// How long a camera and its reader are waited for.
struct CameraPatience {
  std::chrono::milliseconds end{3000};      ///< for its end after stop(); then the thread that reads it is left behind
  std::chrono::milliseconds silence{5000};  ///< for data that follow its first ones; then a warning is logged
  std::chrono::milliseconds reader{kBehindUs / 1000};  ///< for the reader to take data; then its delay is logged
};

/// A setting that can change while a camera runs.
struct CameraControl {
  std::string name;             ///< that of a bias, "max-event-rate" (events/s, 0 = no limit), or "roi"
  std::string value;            ///< a number, or the regions: "X,Y,WIDTH,HEIGHT", several with spaces, or "all"
  int64_t least = 0, most = 0;  ///< range of a number; equal = not a number
};

/// A source of live events, which camera plugins implement. The concatenated bytes of all reads are a recording. For a
/// camera, it has Prophesee's RAW format: a header ("% evt 3.0", "% geometry 1280x720", "% end"), then event words.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Called once, before start(). Fails with kUnsupported if `setup` asks for something that the camera does not have;
  /// the default implementation refuses every setting.
  [[nodiscard]] virtual Result<void> set_up(const CameraSetup& setup);

  /// Starts the delivery of events. Fails with kNotFound (no camera), kIo, and kInvalidValue (a setting was refused).
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next bytes and replaces `bytes` by them. Returns false at the end of a recording, and after stop()
  /// as soon as everything was returned that had arrived by then. Fails with kIo, also if a camera ends by itself. One
  /// thread calls it without delay.
  [[nodiscard]] virtual Result<bool> read(std::vector<uint8_t>& bytes) = 0;

  /// Returns the number of buffers that the camera or its driver lost before the bytes that read() returned last. The
  /// reading thread calls it once after each read().
  [[nodiscard]] virtual uint64_t lost_buffers() { return 0; }

  /// Makes read() come to its end soon. Called by another thread.
  virtual void stop() = 0;

  /// Returns whether unread data are kept for any length of time, as by the sender of a pipe. A camera does not wait:
  /// it is always read, and what exceeds the buffer of its reader is dropped and counted.
  [[nodiscard]] virtual bool keeps_unread() const { return false; }

  [[nodiscard]] virtual CameraPatience patience() const { return {}; }

  /// Returns what was left out of the events before they became bytes, e.g. from a damaged file that is replayed. May
  /// be called by any thread.
  [[nodiscard]] virtual DecodeSummary left_out() const { return {}; }

  /// Returns the settings that change() accepts, with their present values. May be called by any thread after start().
  [[nodiscard]] virtual std::vector<CameraControl> controls() { return {}; }

  /// Changes a setting of the running camera. May be called by any thread after start(). Fails with kUnsupported (it
  /// has no such setting) and kInvalidValue (it refuses the value).
  [[nodiscard]] virtual Result<void> change(const std::string& name, const std::string& value);

  /// Returns the biases of the sensor in the form that the vendor's programs read (.bias), after the camera has
  /// started; empty if it has none.
  [[nodiscard]] virtual std::string bias_file_text() const { return {}; }
};

using CameraPtr = std::unique_ptr<Camera>;

/// Number of bytes that may wait between a camera and its reader. Camera::keeps_unread() describes what happens to
/// more.
inline constexpr size_t kMaxWaitingBytes = size_t{1} << 26;

/// Access to the settings of a camera while another thread reads it. All functions may be called by any thread.
class RunningCamera {
 public:
  /// Called when the camera has started. Does not keep the camera, which ends with its input.
  void set(const std::shared_ptr<Camera>& camera);
  /// Returns Camera::controls() as of the last change; empty if no camera has started.
  [[nodiscard]] std::vector<CameraControl> controls() const;
  /// Calls Camera::change(). Fails as it does, and with kNotFound if no camera runs.
  [[nodiscard]] Result<void> change(const std::string& name, const std::string& value);

 private:
  mutable std::mutex mutex_;
  std::weak_ptr<Camera> camera_;  ///< weak, because the setup of the camera may hold this object
  std::vector<CameraControl> controls_;
};

/// The bytes of a live input.
class LiveSource : public ByteSource {
 public:
  /// Ends the input at the given time, as a stop request does: bytes that have arrived by then are still read.
  virtual void end_at(std::chrono::steady_clock::time_point time) = 0;

  /// Returns Camera::bias_file_text().
  [[nodiscard]] virtual std::string bias_file_text() const = 0;
};

/// One kind of camera.
struct CameraPlugin {
  std::string name;         ///< as in camera://NAME or camera://NAME/ADDRESS
  std::string description;  ///< text for the help: the camera and the meaning of ADDRESS
  std::function<Result<CameraPtr>(const std::string& address)> open = {};
  /// Returns the addresses of the connected cameras; empty = they cannot be listed.
  std::function<Result<std::vector<std::string>>()> list = {};
};

/// Returns all plugins that were added. The list only grows.
[[nodiscard]] std::vector<CameraPlugin> camera_plugins();

/// Adds a plugin for this process, replacing any of the same name.
void add_camera_plugin(const CameraPlugin& plugin);

/// Adds a function that is called once, when the list of all plugins is needed or a name is unknown, and returns more
/// plugins. Those whose names are known are left out with a warning.
void add_camera_plugins(std::function<std::vector<CameraPlugin>()> load);

/// Returns whether a name has the form camera://NAME[/ADDRESS], replay:FILE or tcp://ADDRESS:PORT (the latter two
/// abbreviate camera://replay/FILE and camera://tcp/ADDRESS:PORT).
[[nodiscard]] bool is_camera_name(const std::string& name);

/// Returns the path that the name of a camera contains: that of a replayed recording or of a named pipe. Returns an
/// empty path for all other cameras.
[[nodiscard]] std::filesystem::path path_of_camera(const std::string& name);

/// Returns whether a name denotes a live source: "-", a camera, a named pipe or a device.
[[nodiscard]] bool is_live_recording(const std::string& name);

/// Returns whether the program has added a camera.
[[nodiscard]] bool has_cameras();

/// Returns the length of the path at the beginning of such an address.
[[nodiscard]] size_t replay_path_size(const std::string& address);

/// Applies the settings to a camera, and starts it and a thread that reads its bytes. The source ends with the camera,
/// and stops it when it is destroyed. If the camera fails after its first bytes, the source ends there with a warning,
/// and LiveBacklog::failure contains the reason. Fails as Camera::set_up() and Camera::start() do.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> start_camera_source(CameraPtr camera, std::string name,
                                                                      const CameraSetup& setup = {});

/// Opens the bytes of a live input: a camera (see is_camera_name()), a named pipe, a device, or standard input ("-").
/// The camera is set up and started. A separate thread reads its bytes and buffers up to 64 MiB, so that a slow reader
/// loses nothing for a while. If the reader falls behind, this is logged once and counted in DecodeSummary::live.
/// open_named_recording() opens the same inputs as recordings, whose RecordingReader::arrival() returns when the bytes
/// arrived. Fails with kNotFound (no such plugin; lists those that exist), kInvalidValue (a file), and as the plugin,
/// Camera::set_up() and Camera::start() do.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> open_live_bytes(const std::string& name,
                                                                  const CameraSetup& setup = {});

}  // namespace e2lf::recordings
