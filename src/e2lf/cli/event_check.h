// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/cli/inputs.h"
#include "e2lf/capture/event_images.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Means of |simulated - given| over pixels and transitions.
struct EventError {
  double at_first = 0;   ///< every pixel's reference at the first log intensity, as in the paper's model
  double least = 0;      ///< references a part of a threshold above that, the same for all pixels: the best of quarters
  double residue = 0.0;  ///< that part, 0..1
};

/// How well a reconstruction explains the events it was made from: it is simulated without noise through the codes and
/// compared. Needs no true light field, so it also judges real captures, whose references may start above black. `gain`
/// is what the light field has been multiplied with. Fails with kShape when the codes do not have one pattern more than
/// there are transitions, and as sensor::simulate_events does.
[[nodiscard]] Result<EventError> event_error(const KnownCodes& known, const lightfield::LightField& light_field,
                                             float gain, const events::EventImages& given);

}  // namespace e2lf::cli
