// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

using capture::CodedIntensities;
using capture::event_model_name;
using capture::EventModel;

/// Computes the coded intensities of a grey light field, I_n = sum(a_n * L) / views (Eq. 1). Views are summed in the
/// order of their numbers, so that the result is the same for any number of threads and any instruction set. Fails with
/// kShape if the views of codes and light field differ or if the light field has colour.
[[nodiscard]] Result<CodedIntensities> coded_intensities(const capture::Codes& codes,
                                                         const LightFieldView& light_field);

/// Checks that `codes` can be applied to `light_field`, as coded_intensities() does.
[[nodiscard]] Result<void> check_fit(const capture::Codes& codes, const LightFieldView& light_field);

struct ImageOptions {
  float sigma = 0.005F;  ///< standard deviation of the noise of each pixel in each image
  float gain = 1.0F;     ///< scene brightness, which multiplies every intensity
  uint64_t seed = 1;     ///< seed of the noise
};

/// Returns the intensity images that a measurement of this kind contains for a grey light field: gain * I_n (Eq. 1) for
/// each pattern, or their sum, or the image behind a lens array, plus Gaussian noise. There is no image if the kind has
/// none. Lenses at the right and lower edge may cover less than 8 pixels of the light field; they average over those
/// pixels, and the image has the size of whole lenses. Values are not clamped. The result does not depend on the number
/// of threads. Fails as coded_intensities() does, with kShape if a lens array is used with other than 8x8 views, and
/// with kInvalidValue for a gain or noise that is negative or not finite.
[[nodiscard]] Result<capture::CodedIntensities> measure_images(capture::MeasurementKind kind,
                                                               const capture::Codes& codes,
                                                               const LightFieldView& light_field,
                                                               const ImageOptions& options);

/// Returns the event model with this event_model_name(). Fails with kInvalidValue for any other name.
[[nodiscard]] Result<EventModel> event_model_from_name(const std::string& name);

struct EventModelOptions {
  EventModel model = EventModel::kReferenceAware;
  capture::SensorConstants constants = {};
  float gain = 1.0F;  ///< scene brightness, which multiplies every intensity
  /// The largest residue: the reference of each pixel starts up to this many thresholds (0 to 1) above the first log
  /// intensity, where the last event of the preceding decrease leaves it. It is 0 in the model of the paper.
  float residue = 0.0F;
  uint64_t seed = 1;  ///< seed of the noise; use another one for each cycle
};

/// The lower limit of noisy thresholds.
inline constexpr float kMinThreshold = 0.01F;
/// The stream of the generator for the residue, beyond those of any transition.
inline constexpr uint64_t kResidueStream = uint64_t{1} << 32;

/// Simulates the event images of one cycle. Transition k = 1..N-1 leads from pattern k-1 to pattern k:
///   E_k = trunc((ln(gain * I_k + eps) - V + sigma_w * w) / max(tau + sigma_z * z, kMinThreshold)), toward zero,
/// then V += tau * E_k (reference-aware: the nominal threshold) or V = ln(gain * I_k + eps) (quantised). V starts at
/// ln(gain * I_0 + eps) + tau * residue * u, whose first term is ln(eps) if the sequence begins with black; u is
/// uniform in 0..1, from the first word of CounterRng(seed, kResidueStream).bits(p). Negative and NaN intensities count
/// as 0.
///
/// The noise of pixel p = width * y + x in transition k (from 1), with t = k - 1, is w, z = {r cos, r sin} as in
/// CounterRng::normal2, from the words 2 (t % 2) and 2 (t % 2) + 1 of CounterRng(seed, t / 2).bits(p). The events are
/// bit-identical for any number of threads and any instruction set. Counts beyond int16 are saturated, which is logged
/// as a warning.
///
/// Fails with kInvalidValue (a constant that is not finite, eps or tau not positive, a negative sigma or gain, or a
/// residue outside 0..1) and kShape (fewer than two patterns, 2^32 pixels or more, or codes that do not fit the light
/// field).
[[nodiscard]] Result<capture::EventImages> simulate_events(const CodedIntensities& intensities,
                                                           const EventModelOptions& options);

/// Simulates the events directly from a light field. The coded intensities never leave the cache.
[[nodiscard]] Result<capture::EventImages> simulate_events(const capture::Codes& codes,
                                                           const LightFieldView& light_field,
                                                           const EventModelOptions& options);

/// Checks the options as simulate_events() does.
[[nodiscard]] Result<void> validate(const EventModelOptions& options);

}  // namespace e2lf::sensor
