// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>

#include "e2lf/recon/reconstruct.h"

namespace e2lf::pipeline {

/// The light field of one cycle.
struct Field {
  lightfield::LightField light_field;  ///< gain * (value - black)
  float black = 0, gain = 1;           ///< the same for a whole sequence
  double reconstruct_s = 0;            ///< duration of the method
  std::optional<double> motion = {};   ///< recon::scene_motion(), if the sequence has a method for lit transitions
  bool is_of_lit = false;              ///< reconstructed from the lit transitions, because of the motion
};

/// The brightness of a sequence. Empty values are determined from the first cycle that has events.
struct Tone {
  std::optional<float> gain = {};     ///< empty = auto_gain() of the light field after subtraction of the black level
  std::optional<float> black = 0.0F;  ///< empty = auto_black()
};

/// Determines the empty values of a tone from the light field of a measurement that has events, and applies the tone.
void apply_tone(const capture::MeasurementView& measurement, const LightFieldOutput& field, Tone& tone);

/// Receives each light field before its brightness is changed, and the measurement from which it was reconstructed.
using FieldObserver =
    std::function<Result<void>(const lightfield::LightField&, const capture::Measurement&, bool is_of_lit)>;

/// Reconstructs the light fields of a sequence of cycles. The brightness is determined from the first cycle that has
/// events and is then kept, so that the sequence does not flicker.
class FieldSequence {
 public:
  /// Measurements are sums over this number of `cycles`. `lit` replaces the method in cycles whose
  /// recon::scene_motion() exceeds recon::kMuchMotion.
  FieldSequence(recon::Method method, Tone tone, size_t cycles = 1, std::optional<recon::Method> lit = {})
      : method_(std::move(method)), tone_(tone), cycles_(cycles), lit_(std::move(lit)) {}

  /// Reconstructs the next light field. Fails as the method and the observer do.
  [[nodiscard]] Result<Field> next(const capture::Measurement& measurement, const ProgressFn& progress = {},
                                   const FieldObserver& observer = {});

  /// Returns the brightness. Values to be determined are empty until the first cycle that has events.
  [[nodiscard]] const Tone& tone() const { return tone_; }

 private:
  recon::Method method_;
  Tone tone_;
  size_t cycles_;
  std::optional<recon::Method> lit_;
};

}  // namespace e2lf::pipeline
