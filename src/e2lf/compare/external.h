// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// Reconstructs a light field with a program of the user, which is called as `COMMAND... EVENTS.npz LIGHT_FIELD.npy`:
/// it reads the event images of all cycles, with their patterns and the camera, and writes the light field, float32
/// [view_y, view_x, y, x]. What it prints goes to stderr. Fails with kNotFound (it cannot be started), kUnsupported (it
/// ends with an error), kCancelled (a stop was requested, which ends the program), and as write_event_images() and
/// read_light_field() do.
[[nodiscard]] Result<lightfield::LightField> run_external(const std::vector<std::string>& command,
                                                          const capture::EventImageFile& events);

}  // namespace e2lf::compare
