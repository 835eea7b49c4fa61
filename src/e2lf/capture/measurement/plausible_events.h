// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Whether no pixel has an event.
[[nodiscard]] bool is_without_events(const EventImages& images);

/// Why the event images of a cycle are hardly those of a scene, each reason a sentence that says what was found; none
/// where they may well be. Looked for are images without events, fewer events than one in fifty pixels, counts beyond
/// 100 in half of an image, counts of one sign alone and, where `codes` names the patterns, counts of the wrong sign
/// where a pattern opens or closes cells and does nothing else, as after black. Name the patterns for pixels that follow
/// a change at once only: slow ones still make OFF events of the change to black.
[[nodiscard]] std::vector<std::string> event_doubts(const EventImages& images, const Codes* codes = nullptr);

/// Whether the counts have the opposite sign of what the patterns say: at least kClearlyWrong of the events of the
/// transitions that open cells alone, or close cells alone. False where there are fewer than 1000 such events.
[[nodiscard]] bool is_polarity_inverted(const EventImages& images, const Codes& codes);
inline constexpr double kClearlyWrong = 0.8;

}  // namespace e2lf::capture
