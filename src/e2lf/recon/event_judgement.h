// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/recon/event_check.h"

namespace e2lf::recon {

/// One way from what was measured to a light field: a network or the inversion.
using Method =
    std::function<Result<lightfield::LightField>(const capture::Measurement& measurement, const ProgressFn& progress)>;

/// Another camera that may have made the events, with the method that is told it.
struct Rival {
  Method method;
  EventCheck check;
};

enum class Verdict {
  kGood,           ///< the events are explained about as well as their noise allows
  kUsual,          ///< the errors of an ordinary reconstruction come on top of the noise
  kRivalBetter,    ///< the rival camera explains the events much better
  kChangedBetter,  ///< the events are explained much better with other signs or in another order
  kWrong,          ///< the patterns or the polarity of the events are likely wrong
};

/// How the error of a light field against its events compares with what the camera's noise alone would make of it.
/// That ratio has one scale for dark and bright scenes and for all cameras.
struct EventJudgement {
  double error = 0;                        ///< EventError::least in the middle of the picture
  double noise_error = 0;                  ///< the same for the light field simulated again with the camera's noise
  double ratio = 0;                        ///< of the two
  std::optional<double> rival_error = {};  ///< EventError::least of the rival's light field
  /// EventError::least of the best light field that is made of changed events, in a smaller window, and of the given
  /// ones in that window; how they were changed: "with inverted polarity", "in the order 2, 0, 1". Without a method: 0.
  double changed_error = 0, unchanged_error = 0;
  std::string change = {};
  Verdict verdict = Verdict::kGood;
};

/// Judges a light field by its events in a window of at most 512 px a side in the middle of the picture. The rival's
/// light field is made there too. Where there is a `method`, it also makes light fields of the events with inverted
/// signs, in reversed order and rotated, in a window of at most 192 px: wrong signs or a wrong order that `events` may
/// have. The method must know the camera of `check`, otherwise the ratio and the comparison say nothing about the
/// events. Fails as event_error() and the methods do.
[[nodiscard]] Result<EventJudgement> judge(const EventCheck& check, const lightfield::LightField& light_field,
                                           const capture::EventImages& events, const std::optional<Rival>& rival,
                                           const Method& method = {});

/// The words of a run record: "good", "usual", "rival-better", "changed-better", "wrong".
[[nodiscard]] const char* verdict_name(Verdict verdict);

}  // namespace e2lf::recon
