// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// A source of live events: what a camera plugin implements. The bytes of all reads one after the other are a
/// recording, for a camera one in Prophesee's RAW format: a header ("% evt 3.0", "% geometry 1280x720", "% end"), then
/// words.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Begins to deliver. Fails with kIo.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next bytes and replaces `bytes` by them. False when there will be no more, or after stop(). Called
  /// by one thread, without delay: what the camera cannot keep until then is lost. Fails with kIo.
  [[nodiscard]] virtual Result<bool> read(std::vector<uint8_t>& bytes) = 0;

  /// Makes read() return soon; called by another thread.
  virtual void stop() = 0;

  /// Whether what is not read yet is kept for as long as it takes, as by the sender of a pipe. The driver of a camera
  /// keeps little, and loses the rest.
  [[nodiscard]] virtual bool keeps_unread() const { return false; }

  /// What was left out of the events before they became bytes, e.g. of a damaged file that is replayed. Called by any
  /// thread.
  [[nodiscard]] virtual DecodeSummary left_out() const { return {}; }
};

/// One kind of camera.
struct CameraPlugin {
  std::string name;         ///< as in camera://NAME or camera://NAME/ADDRESS
  std::string description;  ///< for help texts: what it is, and what ADDRESS means
  Result<std::unique_ptr<Camera>> (*open)(const std::string& address) = nullptr;
};

/// All plugins of this build, and those that were added. The list grows only.
[[nodiscard]] std::vector<CameraPlugin> camera_plugins();

/// Adds a plugin for this process; one of the same name is replaced.
void add_camera_plugin(const CameraPlugin& plugin);

/// Whether a name is of the form camera://NAME[/ADDRESS], replay:FILE or tcp://ADDRESS:PORT (the latter two short for
/// camera://replay/FILE and camera://tcp/ADDRESS:PORT).
[[nodiscard]] bool is_camera_name(const std::string& name);

/// Opens and starts a camera as a recording: bytes are taken from it by a thread of their own and wait, up to 64 MiB,
/// until they are read, so that a slow reader loses nothing for a while. A reader that falls behind is told once in the
/// log, and DecodeSummary::live counts it. RecordingReader::arrival() tells when they came. Fails with kNotFound (no
/// such plugin: names those there are), kInvalidValue (a name not of that form), and as the plugin and open_recording()
/// do.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_camera(const std::string& name,
                                                                   const OpenOptions& options = {});

}  // namespace e2lf::recordings
