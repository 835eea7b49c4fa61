// SPDX-License-Identifier: MIT
#pragma once

namespace e2lf::capture {

/// The constants of the paper's event sensor (Eq. 3 and 8). The defaults are those of a Prophesee EVK4. Intensities are
/// normalised by the number of views.
struct SensorConstants {
  float eps = 0.01F;       ///< dark level added to the intensity
  float tau = 0.30F;       ///< contrast threshold, natural logarithm
  float sigma_w = 0.175F;  ///< standard deviation of the log-intensity noise
  float sigma_z = 0.04F;   ///< standard deviation of the threshold
  float sigma_i = 0.005F;  ///< standard deviation of the noise of intensity images, if they are measured

  bool operator==(const SensorConstants&) const = default;
};

/// The paper's models of how a pixel generates events.
enum class EventModel {
  kQuantised,       ///< Eq. 8: events are counted from the coded intensity before the transition
  kReferenceAware,  ///< Eq. 9 and 10: each pixel stores the log intensity of its last event as its reference
};

/// The names of the event models in files and options, in the order of the enum.
inline constexpr const char* kEventModelNames[] = {"quantised", "reference-aware"};

[[nodiscard]] constexpr const char* event_model_name(EventModel model) {
  return kEventModelNames[static_cast<int>(model)];
}

}  // namespace e2lf::capture
