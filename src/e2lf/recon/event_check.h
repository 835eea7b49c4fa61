// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::recon {

/// What the camera did, as far as the check of a light field against its events asks.
struct EventCheck {
  capture::Codes codes;
  capture::SensorConstants constants;
  sensor::EventModel model = sensor::EventModel::kReferenceAware;
  std::optional<capture::SensorProfile> pixels = {};  ///< physical ones, in place of constants and model
};

/// Means of |simulated - given| over pixels and transitions.
struct EventError {
  double at_first = 0;   ///< every pixel's reference at the first log intensity, as in the paper's model
  double least = 0;      ///< references a part of a threshold above that, the same for all pixels: the best of quarters
  double residue = 0.0;  ///< that part, 0..1
};

/// How well a reconstruction explains the events it was made from: its coded intensities are counted without noise by
/// Eq. 8 or Eq. 9, 10 and compared. Physical pixels count as sensor::simulate_pixel_events() does, without noise and
/// mismatch and with references in the middle of where black leaves them; at_first and least are the same then. Needs
/// no true light field, so it also judges real captures, whose references may start above black. `gain` is what the
/// light field has been multiplied with. Fails with kShape when the codes do not have one pattern more than there are
/// transitions, and as sensor::coded_intensities() does.
[[nodiscard]] Result<EventError> event_error(const EventCheck& check, const lightfield::LightField& light_field,
                                             float gain, const capture::EventImages& given);

}  // namespace e2lf::recon
