// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/capture/measurement/colour_filter.h"
#include "e2lf/recon/event_judgement.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::pipeline {

/// Each colour on its own, from the pixels behind its filter, by a method for grey; of two filters of one colour the
/// mean. The light field has a pixel for each block of 2x2. Fails as `grey` does, and with kShape where the images have
/// an odd side.
[[nodiscard]] recon::Method colour_method(recon::Method grey, const capture::ColourFilter& filter);

/// The light field of one cycle.
struct Field {
  lightfield::LightField light_field;                   ///< less the black level, multiplied with the gain
  float black = 0, gain = 1;                            ///< the same for all of a sequence
  double reconstruct_s = 0;                             ///< what the method took
  std::optional<recon::EventError> error = {};          ///< against its events, where the camera is known
  std::optional<recon::EventJudgement> judgement = {};  ///< of that error, at the first of a sequence
  std::optional<double> motion = {};                    ///< recon::scene_motion(), if the sequence has a LitMethod
  bool is_of_lit = false;                               ///< made of the lit transitions, because of the motion
};

/// What reconstructs the cycles in which the scene moves too much for the transitions of the whole cycle: a method for
/// the lit transitions of the same patterns, and the comparison with their events.
struct LitMethod {
  recon::Method method;
  std::optional<recon::EventCheck> check = {};
};

/// What a sequence does to brightness; nothing = found at the first light field of a cycle with events.
struct Tone {
  std::optional<float> gain = {};     ///< nothing = auto_gain() of what is left of the light field above black
  std::optional<float> black = 0.0F;  ///< nothing = auto_black()
};

/// How FieldSequence judges the comparison with the events at the first light field.
enum class Judging {
  kNone,     ///< not at all, for methods that do not know the camera
  kNoise,    ///< by the noise of the camera
  kChanges,  ///< and by light fields of changed events, which takes several more runs of the method on a small window
};

/// Light fields of cycles, one after the other. Their brightness is found at the first with events and kept, so that a
/// sequence does not flicker.
class FieldSequence {
 public:
  /// `check`: nothing = no comparison with the events. `rival`: another camera that judge() compares with. `lit`:
  /// takes the place of the method in cycles whose recon::scene_motion() exceeds recon::kMuchMotion.
  FieldSequence(recon::Method method, Tone tone, std::optional<recon::EventCheck> check,
                std::optional<recon::Rival> rival = {}, Judging judging = Judging::kNone,
                std::optional<LitMethod> lit = {})
      : method_(std::move(method)),
        tone_(tone),
        check_(std::move(check)),
        rival_(std::move(rival)),
        judging_(judging),
        lit_(std::move(lit)) {}

  /// The comparison with the events is made where there are some. Fails as the method and event_error() do.
  [[nodiscard]] Result<Field> next(const capture::Measurement& measurement, const ProgressFn& progress = {});

  /// Nothing that is to be found is known before the first.
  [[nodiscard]] const Tone& tone() const { return tone_; }

 private:
  [[nodiscard]] Result<void> compare(const recon::EventCheck& check, const recon::Method& method,
                                     const capture::Measurement& measurement, Field& field);

  recon::Method method_;
  Tone tone_;
  std::optional<recon::EventCheck> check_;
  std::optional<recon::Rival> rival_;
  Judging judging_ = Judging::kNone;
  std::optional<LitMethod> lit_;
  bool is_first_ = true;
};

}  // namespace e2lf::pipeline
