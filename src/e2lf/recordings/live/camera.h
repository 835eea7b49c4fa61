// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/camera_setup.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// A source of live events: what a camera plugin implements. The bytes of all reads one after the other are a
/// recording, for a camera one in Prophesee's RAW format: a header ("% evt 3.0", "% geometry 1280x720", "% end"), then
/// words.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Called once, before start(). Fails with kUnsupported where the camera has not what `setup` asks for; that is all
  /// of it for what has no settings.
  [[nodiscard]] virtual Result<void> set_up(const CameraSetup& setup);

  /// Begins to deliver. Fails with kNotFound (no camera), kIo, and for settings that the camera refuses kInvalidValue.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next bytes and replaces `bytes` by them. False when there will be no more: that is at the end of a
  /// recording, or after stop(), once all has been delivered that had come until then. A camera that ends otherwise
  /// fails with kIo. Called by one thread, without delay.
  [[nodiscard]] virtual Result<bool> read(std::vector<uint8_t>& bytes) = 0;

  /// Makes read() come to its end soon; called by another thread.
  virtual void stop() = 0;

  /// Whether what is not read yet is kept for as long as it takes, as by the sender of a pipe. A camera does not wait:
  /// it is read all the time, and what its reader is too slow for is dropped and counted.
  [[nodiscard]] virtual bool keeps_unread() const { return false; }

  /// What was left out of the events before they became bytes, e.g. of a damaged file that is replayed. Called by any
  /// thread.
  [[nodiscard]] virtual DecodeSummary left_out() const { return {}; }

  /// The settings of the sensor as the vendor's programs read them (.bias), once the camera has started; empty where it
  /// has none.
  [[nodiscard]] virtual std::string bias_file_text() const { return {}; }
};

/// The bytes of a live input as they come.
class LiveSource : public ByteSource {
 public:
  /// Ends the input at that time, as a request to stop does: what has come until then is still read.
  virtual void end_at(std::chrono::steady_clock::time_point time) = 0;

  /// See Camera::bias_file_text().
  [[nodiscard]] virtual std::string bias_file_text() const = 0;
};

/// One kind of camera.
struct CameraPlugin {
  std::string name;         ///< as in camera://NAME or camera://NAME/ADDRESS
  std::string description;  ///< for help texts: what it is, and what ADDRESS means
  Result<std::unique_ptr<Camera>> (*open)(const std::string& address) = nullptr;
  /// The addresses of the cameras that are connected; null = there is no such list.
  Result<std::vector<std::string>> (*list)() = nullptr;
};

/// All plugins of this build, and those that were added. The list grows only.
[[nodiscard]] std::vector<CameraPlugin> camera_plugins();

/// Adds a plugin for this process; one of the same name is replaced.
void add_camera_plugin(const CameraPlugin& plugin);

/// Whether a name is of the form camera://NAME[/ADDRESS], replay:FILE or tcp://ADDRESS:PORT (the latter two short for
/// camera://replay/FILE and camera://tcp/ADDRESS:PORT).
[[nodiscard]] bool is_camera_name(const std::string& name);

/// Opens a camera, sets it up and starts it: bytes are taken from it by a thread of their own and wait, up to 64 MiB,
/// until they are read, so that a slow reader loses nothing for a while. A reader that falls behind is told once in the
/// log, and DecodeSummary::live counts it. Fails with kNotFound (no such plugin: names those there are), kInvalidValue
/// (a name not of that form), and as the plugin and Camera::start() do.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> open_camera_bytes(const std::string& name,
                                                                    const CameraSetup& setup = {});

/// The same as a recording, set up as options.camera says. RecordingReader::arrival() tells when bytes came. Fails as
/// open_recording() too.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_camera(const std::string& name,
                                                                   const OpenOptions& options = {});

}  // namespace e2lf::recordings
