// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>

#include "e2lf/recon/event_check.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::recon {

/// One way from event images to a light field: a network or the inversion.
using Method =
    std::function<Result<lightfield::LightField>(const capture::EventImages& images, const ProgressFn& progress)>;

/// A Reconstructor as a method. It makes `passes` over sums of `cycles` cycles; see Reconstructor::reconstruct().
[[nodiscard]] Method network_method(Reconstructor reconstructor, size_t passes = 1, size_t cycles = 1);

/// The light field of one cycle.
struct Field {
  lightfield::LightField light_field;    ///< multiplied with the gain
  float gain = 1;                        ///< the same for all of a sequence
  double reconstruct_s = 0;              ///< what the method took
  std::optional<EventError> error = {};  ///< against its events, where the camera is known
};

/// Light fields of cycles, one after the other. Their brightness is found at the first and kept, so that a sequence
/// does not flicker.
class FieldSequence {
 public:
  /// `gain`: nothing = auto_gain() of the first. `check`: nothing = no comparison with the events.
  FieldSequence(Method method, std::optional<float> gain, std::optional<EventCheck> check)
      : method_(std::move(method)), gain_(gain), check_(std::move(check)) {}

  /// Fails as the method and event_error() do.
  [[nodiscard]] Result<Field> next(const capture::EventImages& images, const ProgressFn& progress = {});

  /// Nothing before the first.
  [[nodiscard]] std::optional<float> gain() const { return gain_; }

 private:
  Method method_;
  std::optional<float> gain_;
  std::optional<EventCheck> check_;
};

}  // namespace e2lf::recon
