// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Returns whether no pixel has an event.
[[nodiscard]] bool is_without_events(const EventImages& images);

/// Returns the reasons why the event images of a cycle are unlikely to show a scene, one sentence each; none if they
/// are plausible. The function looks for images without events, fewer events than one per fifty pixels, counts of 100
/// or more in over half of an image, and counts of a single sign. If `codes` contains the patterns, it also looks for
/// counts of the wrong sign in transitions that only open or only close cells, such as the one after black. Pass the
/// patterns only for pixels that respond at once: slow pixels still send OFF events of the change to black.
[[nodiscard]] std::vector<std::string> event_doubts(const EventImages& images, const Codes* codes = nullptr);

/// Returns whether the counts have the opposite sign of what the patterns imply: at least a fraction kClearlyWrong of
/// the events in transitions that only open or only close cells. Returns false if there are fewer than 1000 such
/// events.
[[nodiscard]] bool is_polarity_inverted(const EventImages& images, const Codes& codes);
inline constexpr double kClearlyWrong = 0.8;

}  // namespace e2lf::capture
