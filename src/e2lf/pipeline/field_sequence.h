// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/capture/measurement/colour_filter.h"
#include "e2lf/recon/event_judgement.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::pipeline {

/// Returns a method that reconstructs each colour separately with the method `grey`, from the pixels behind its filter.
/// If two filters of a block have the same colour, their mean is used. The light field has one pixel for each block of
/// 2x2. The method fails as `grey` does, and with kShape if a side of the images is odd.
[[nodiscard]] recon::Method colour_method(recon::Method grey, const capture::ColourFilter& filter);

/// The light field of one cycle.
struct Field {
  lightfield::LightField light_field;                   ///< gain * (value - black)
  float black = 0, gain = 1;                            ///< the same for a whole sequence
  double reconstruct_s = 0;                             ///< duration of the method
  std::optional<recon::EventError> error = {};          ///< error of its simulated events, if the camera is known
  std::optional<recon::EventJudgement> judgement = {};  ///< judgement of that error; only for the first of a sequence
  std::optional<double> motion = {};                    ///< recon::scene_motion(), if the sequence has a LitMethod
  bool is_of_lit = false;                               ///< reconstructed by the LitMethod, because of the motion
};

/// Reconstructs the cycles during which the scene moves too much for the transitions of the whole cycle: a method for
/// the lit transitions of the same patterns, and the comparison with their events.
struct LitMethod {
  recon::Method method;
  std::optional<recon::EventCheck> check = {};
};

/// The brightness of a sequence. Empty values are determined from the first cycle that has events.
struct Tone {
  std::optional<float> gain = {};     ///< empty = auto_gain() of the light field after subtraction of the black level
  std::optional<float> black = 0.0F;  ///< empty = auto_black()
};

/// How FieldSequence judges the comparison with the events of the first light field.
enum class Judging {
  kNone,     ///< not at all, for methods that do not use the sensor profile
  kNoise,    ///< determined by comparison with the noise of the camera
  kChanges,  ///< also by light fields of changed events, which requires several more runs on a small window
};

/// Reconstructs the light fields of a sequence of cycles. The brightness is determined from the first cycle that has
/// events and is then kept, so that the sequence does not flicker.
class FieldSequence {
 public:
  /// If `check` is empty, results are not compared with their events. `rival` is another camera for judge(). `lit`
  /// replaces the method in cycles whose recon::scene_motion() exceeds recon::kMuchMotion.
  FieldSequence(recon::Method method, Tone tone, std::optional<recon::EventCheck> check,
                std::optional<recon::Rival> rival = {}, Judging judging = Judging::kNone,
                std::optional<LitMethod> lit = {})
      : method_(std::move(method)),
        tone_(tone),
        check_(std::move(check)),
        rival_(std::move(rival)),
        judging_(judging),
        lit_(std::move(lit)) {}

  /// Reconstructs the next light field and, if it has events, compares them. Fails as the method and event_error() do.
  [[nodiscard]] Result<Field> next(const capture::Measurement& measurement, const ProgressFn& progress = {});

  /// Returns the brightness. Values to be determined are empty until the first cycle that has events.
  [[nodiscard]] const Tone& tone() const { return tone_; }

 private:
  [[nodiscard]] Result<void> compare(const recon::EventCheck& check, const recon::Method& method,
                                     const std::optional<recon::Rival>& rival, const capture::Measurement& measurement,
                                     Field& field);

  recon::Method method_;
  Tone tone_;
  std::optional<recon::EventCheck> check_;
  std::optional<recon::Rival> rival_;
  Judging judging_ = Judging::kNone;
  std::optional<LitMethod> lit_;
  bool is_first_ = true;
};

}  // namespace e2lf::pipeline
