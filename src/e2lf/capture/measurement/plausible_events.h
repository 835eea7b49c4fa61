// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::capture {

/// Whether no pixel has an event.
[[nodiscard]] bool is_without_events(const EventImages& images);

/// Why the event images of a cycle are hardly those of a scene, each reason a sentence that says what was found; none
/// where they may well be. Looked for are images without events, fewer events than one in fifty pixels, counts beyond
/// 100 in half of an image, and counts of one sign alone.
[[nodiscard]] std::vector<std::string> event_doubts(const EventImages& images);

}  // namespace e2lf::capture
