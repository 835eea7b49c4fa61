// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/field_sequence.h"

#include <chrono>

#include "e2lf/recon/scene_motion.h"

namespace e2lf::pipeline {

void apply_tone(const capture::MeasurementView& measurement, const LightFieldOutput& field, Tone& tone) {
  // Without events, the brightness of the scene is unknown; a later cycle determines it.
  const bool has_scene = !capture::has_events(measurement.kind) || !capture::is_without_events(measurement.events);
  if (!tone.black && has_scene) tone.black = recon::auto_black(field);
  const float black = tone.black.value_or(0.0F);
  if (!tone.gain && has_scene) tone.gain = recon::auto_gain(field, black);
  recon::apply_tone(field, black, tone.gain.value_or(1.0F));
}

Result<Field> FieldSequence::next(const capture::Measurement& measurement, const ProgressFn& progress,
                                  const FieldObserver& observer) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Field field;
  std::optional<capture::Measurement> lit;
  if (lit_) {
    field.motion = recon::scene_motion(measurement.events, cycles_);
    if (*field.motion > recon::kMuchMotion) {
      lit.emplace(recon::lit_transitions(measurement.events));
      if (!measurement.fused.counts.values.empty()) {
        lit->fused = {recon::lit_transitions(measurement.fused.counts), measurement.fused.cycles};
      }
    }
  }
  field.is_of_lit = lit.has_value();
  const capture::Measurement& used = lit ? *lit : measurement;
  E2LF_ASSIGN_OR_RETURN(field.light_field, (lit ? *lit_ : method_)(used, progress));
  field.reconstruct_s = std::chrono::duration<double>(Clock::now() - begin).count();
  if (observer) E2LF_RETURN_IF_ERROR(observer(field.light_field, used, field.is_of_lit));
  apply_tone(used, field.light_field, tone_);
  field.black = tone_.black.value_or(0.0F);
  field.gain = tone_.gain.value_or(1.0F);
  return field;
}

}  // namespace e2lf::pipeline
