// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/recon/event_check.h"

namespace e2lf::recon {

/// A method that reconstructs a light field from a measurement: a network or the inversion.
using Method =
    std::function<Result<lightfield::LightField>(const capture::Measurement& measurement, const ProgressFn& progress)>;

/// Another camera that may have recorded the events, and the method with its sensor profile.
struct Rival {
  Method method;
  EventCheck check;
};

enum class Verdict {
  kGood,           ///< the events are explained about as well as their noise allows
  kUsual,          ///< the error exceeds that of the noise, as usual for a reconstruction
  kRivalBetter,    ///< the rival camera explains the events much better
  kChangedBetter,  ///< the events are explained much better with other signs or in another order
  kWrong,          ///< the patterns or the polarity of the events are probably wrong
};

/// The error of a light field against its events, relative to the error that the noise of the camera alone would cause.
/// This ratio has the same scale for dark and bright scenes and for all cameras.
struct EventJudgement {
  double error = 0;                        ///< EventError::least in the middle of the image
  double noise_error = 0;                  ///< the same for events simulated from the light field with noise
  double ratio = 0;                        ///< error / noise_error
  std::optional<double> rival_error = {};  ///< EventError::least of the rival's light field
  /// EventError::least in a smaller window for the best change of the events and for the given events, 0 without a
  /// method; and the change: "with inverted polarity", "in the order 2, 0, 1".
  double changed_error = 0, unchanged_error = 0;
  std::string change = {};
  Verdict verdict = Verdict::kGood;
};

/// Judges a light field by its events in a window of at most 512x512 px in the middle of the image, in which the
/// rival's light field is also reconstructed. If a `method` is given, it also reconstructs the events with inverted
/// signs and in other orders, in a window of at most 192x192 px, to detect a wrong polarity or order. The method must
/// use the sensor profile of `check`; otherwise, ratio and comparison are meaningless. Fails as event_error() and the
/// methods do.
[[nodiscard]] Result<EventJudgement> judge(const EventCheck& check, const lightfield::LightField& light_field,
                                           const capture::EventImages& events, const std::optional<Rival>& rival,
                                           const Method& method = {});

/// Returns the name for the run record: "good", "usual", "rival-better", "changed-better" or "wrong".
[[nodiscard]] const char* verdict_name(Verdict verdict);

}  // namespace e2lf::recon
