// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

/// The streams of the generator for constant properties of a pixel.
inline constexpr uint64_t kThresholdStream = uint64_t{1} << 33;
inline constexpr uint64_t kHotStream = kThresholdStream + 1;
/// The streams for varying quantities. The number of the pattern or segment is added.
inline constexpr uint64_t kDefectStream = uint64_t{1} << 34;
inline constexpr uint64_t kSegmentStream = uint64_t{1} << 35;
inline constexpr uint64_t kImageStream = uint64_t{1} << 36;

/// The contrast thresholds of one pixel, in natural logarithm.
struct PixelThresholds {
  float on = 0.0F, off = 0.0F;
};

/// Draws the thresholds of a pixel from CounterRng(map_seed, 2^33), where `map_seed` selects one camera, i.e. one set
/// of mismatched pixels.
[[nodiscard]] PixelThresholds draw_thresholds(const capture::PixelConstants& constants, uint64_t map_seed,
                                              uint64_t pixel);

struct PixelModelOptions {
  float gain = 1.0F;      ///< scene brightness, which multiplies every intensity
  uint64_t seed = 1;      ///< seed of what changes from cycle to cycle; use another one for each
  uint64_t map_seed = 1;  ///< seed of the thresholds of the pixels, which are constant
};

/// Simulates the event images of one cycle as physical pixels record them, in a closed form of the camera's cycle: the
/// inverse of the last code, black, then codes 2..N, and for codes of capture::whole_cycle() their inverses and black
/// again. An inverse transmits the light of the open aperture that its code blocks. The log intensity u of the
/// photoreceptor obeys du/dt = K (J - exp u), J = (I + eps) / eps: w = exp(-u) relaxes to 1 / J at the rate K J. The
/// level of the amplifier relaxes to u at its own rate. At the end of each pattern, the noisy level is compared with
/// the reference: count = trunc((level - reference) / threshold), with separate ON and OFF thresholds, and the
/// reference moves by threshold * count. The change to black leaves the reference uniformly distributed within
/// reset_span OFF thresholds above the level, less reset_offset; it produces the OFF events that take the reference
/// there.
///
/// Pixel p draws from CounterRng: the thresholds from (map_seed, 2^33), the reference after black from (seed, 0), and
/// the noise and dark events of transition k from (seed, k). The result does not depend on the number of threads.
/// Counts beyond int16 are saturated.
///
/// Fails with kInvalidValue (a camera of another event model, or a gain that is negative or not finite) and kShape
/// (codes that do not fit the light field, or whose first pattern is not black).
[[nodiscard]] Result<capture::EventImages> simulate_pixel_events(const capture::Codes& codes,
                                                                 const LightFieldView& light_field,
                                                                 const capture::SensorProfile& camera,
                                                                 const PixelModelOptions& options);

}  // namespace e2lf::sensor
