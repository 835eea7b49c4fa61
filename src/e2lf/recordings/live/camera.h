// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// A source of live events, which camera plugins implement. The concatenated bytes of all reads are a recording. For a
/// camera, it has Prophesee's RAW format: a header ("% evt 3.0", "% geometry 1280x720", "% end"), then event words.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Starts the delivery of events. Fails with kIo.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next bytes and replaces `bytes` by them. Returns false at the end and after stop(). One thread calls
  /// it without delay, since events that the camera cannot buffer until then are lost. Fails with kIo.
  [[nodiscard]] virtual Result<bool> read(std::vector<uint8_t>& bytes) = 0;

  /// Makes read() return soon. Called by another thread.
  virtual void stop() = 0;

  /// Returns whether unread data are kept for any length of time, as by the sender of a pipe. The driver of a camera
  /// has a small buffer and loses the rest.
  [[nodiscard]] virtual bool keeps_unread() const { return false; }

  /// Returns what was left out of the events before they became bytes, e.g. from a damaged file that is replayed. May
  /// be called by any thread.
  [[nodiscard]] virtual DecodeSummary left_out() const { return {}; }
};

/// One kind of camera.
struct CameraPlugin {
  std::string name;         ///< as in camera://NAME or camera://NAME/ADDRESS
  std::string description;  ///< for help texts: what it is, and the meaning of ADDRESS
  Result<std::unique_ptr<Camera>> (*open)(const std::string& address) = nullptr;
};

/// Returns all plugins of this build, and those that were added. The list only grows.
[[nodiscard]] std::vector<CameraPlugin> camera_plugins();

/// Adds a plugin for this process, replacing any of the same name.
void add_camera_plugin(const CameraPlugin& plugin);

/// Returns whether a name has the form camera://NAME[/ADDRESS], replay:FILE or tcp://ADDRESS:PORT (the latter two
/// abbreviate camera://replay/FILE and camera://tcp/ADDRESS:PORT).
[[nodiscard]] bool is_camera_name(const std::string& name);

/// Opens and starts a camera as a recording. A separate thread reads its bytes and buffers up to 64 MiB, so that a slow
/// reader loses nothing for a while. If the reader falls behind, this is logged once and counted in
/// DecodeSummary::live. RecordingReader::arrival() returns when the bytes arrived. Fails with kNotFound (no such
/// plugin; lists those that exist), kInvalidValue (a name of another form), and as the plugin and open_recording() do.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_camera(const std::string& name,
                                                                   const OpenOptions& options = {});

}  // namespace e2lf::recordings
