// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::recon {

/// The camera with which the events were recorded, for the check of a light field against its events.
struct EventCheck {
  capture::Codes codes;
  capture::SensorConstants constants;
  sensor::EventModel model = sensor::EventModel::kReferenceAware;
  std::optional<capture::SensorProfile> pixels = {};  ///< physical pixels, which replace `constants` and `model`
  size_t cycles = 1;                                  ///< number of cycles over which the given events are summed
};

/// Means of |simulated - given| over pixels and transitions, of one cycle.
struct EventError {
  double at_first = 0;   ///< if references start at the first log intensity, as in the paper's model
  double least = 0;      ///< if they start at the best residue of 0, 1/4, ..., 1 thresholds above it
  double residue = 0.0;  ///< that residue, in thresholds
};

/// Computes how well a reconstruction explains its events: the events of its coded intensities are simulated without
/// noise by Eq. 8, or Eq. 9 and 10, and compared with the given ones. Physical pixels are simulated as by
/// sensor::simulate_pixel_events(), without noise and mismatch, and with the mean reference after black; at_first and
/// least are equal in this case. No ground truth is needed, so that real captures, whose references may have a residue,
/// can be checked. `gain` is the factor by which the light field was multiplied. Fails with kShape unless there is one
/// pattern more than transitions, and as sensor::coded_intensities() does.
[[nodiscard]] Result<EventError> event_error(const EventCheck& check, const LightFieldView& light_field, float gain,
                                             const PlanesView<const int16_t>& given);

}  // namespace e2lf::recon
