// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::cli {

/// Draws the event images of a cycle side by side: grey for no event, towards red for ON events, towards blue for OFF
/// events, with full colour at the 99 % quantile of the counts.
[[nodiscard]] lightfield::Image event_picture(const capture::EventImages& images);

}  // namespace e2lf::cli
