// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/diagnose/finding.h"

namespace e2lf::diagnose {

/// Returns the reasons why the event images of a cycle are unlikely to show a scene: images without events, fewer
/// events than one per fifty pixels, counts of 100 per cycle or more in over half of an image, and counts of a single
/// sign. If `codes` contains the patterns, counts of the wrong sign in transitions that only open or only close cells
/// are one, too, such as the one after black. Pass the patterns only for pixels that respond at once: slow pixels still
/// send OFF events of the change to black. The counts may be sums over several `cycles`.
[[nodiscard]] Findings check_event_images(const capture::EventImages& images, const capture::Codes* codes = nullptr,
                                          size_t cycles = 1);

}  // namespace e2lf::diagnose
