// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/output.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Returns whether a name denotes a live source: "-", a camera, a named pipe or a device.
[[nodiscard]] bool is_live_recording(const std::string& name);

/// Returns the path of the file or folder that is read if a name is opened: the recording of "replay:FILE?speed=2", or
/// the file behind standard input. Returns an empty path if there is none (a camera, a pipe or a socket).
[[nodiscard]] std::filesystem::path file_of_recording(const std::string& name);

/// Opens a recording by name: a file or standard input ("-") with open_recording(), and the name of a camera
/// (camera://NAME, replay:FILE, tcp://ADDRESS:PORT), a named pipe, or standard input that is a pipe or socket with
/// open_camera().
[[nodiscard]] Result<ReaderPtr> open_named_recording(const std::string& name, const OpenOptions& options = {});

/// Opens the bytes of a live source (see is_live_recording()). Fails as open_camera_bytes() does, and with
/// kInvalidValue for a file.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> open_live_bytes(const std::string& name,
                                                                  const CameraSetup& setup = {});

/// Returns the rules for an output that is made from these inputs, which are named as open_named_recording() takes
/// them: files, replayed recordings, pipes and cameras. The output is live if the first input is not a file.
[[nodiscard]] OutputRules output_rules(const std::vector<std::filesystem::path>& inputs, bool overwrite);

/// Returns the same rules for a recording of this format, with its file of triggers.
[[nodiscard]] OutputRules recording_output_rules(const std::vector<std::filesystem::path>& inputs, bool overwrite,
                                                 const Codec& codec);

/// Returns the function that saves the finished part of a recording in this format.
[[nodiscard]] Recover recover_recording(const Codec& codec);

}  // namespace e2lf::recordings
