// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/cli/inputs.h"
#include "e2lf/events/event_images.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// How well a reconstruction explains the events it was made from: it is simulated without noise through the codes, and
/// the mean of |simulated - given| over pixels and transitions is returned. Needs no true light field, so it also
/// judges real captures. `gain` is what the light field has been multiplied with. Fails with kShape when the codes do
/// not have one pattern more than there are transitions, and as sensor::simulate_events does.
[[nodiscard]] Result<double> event_error(const KnownCodes& known, const lightfield::LightField& light_field, float gain,
                                         const events::EventImages& given);

}  // namespace e2lf::cli
