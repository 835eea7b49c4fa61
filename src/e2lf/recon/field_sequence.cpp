// SPDX-License-Identifier: MIT
#include "e2lf/recon/field_sequence.h"

#include <chrono>
#include <memory>

#include "e2lf/recon/gain.h"

namespace e2lf::recon {

Method network_method(Reconstructor reconstructor, size_t passes, size_t cycles) {
  const auto shared = std::make_shared<Reconstructor>(std::move(reconstructor));
  return [shared, passes, cycles](const capture::Measurement& measurement, const ProgressFn& progress) {
    return shared->reconstruct(measurement, progress, passes, cycles);
  };
}

Result<Field> FieldSequence::next(const capture::Measurement& measurement, const ProgressFn& progress) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Field field;
  E2LF_ASSIGN_OR_RETURN(field.light_field, method_(measurement, progress));
  field.reconstruct_s = std::chrono::duration<double>(Clock::now() - begin).count();
  if (check_ && capture::has_events(measurement.kind)) {
    E2LF_ASSIGN_OR_RETURN(field.error, event_error(*check_, field.light_field, 1.0F, measurement.events));
  }
  if (!tone_.black) tone_.black = auto_black(field.light_field);
  apply_tone(field.light_field, *tone_.black, 1.0F);
  if (!tone_.gain) tone_.gain = auto_gain(field.light_field);
  apply_tone(field.light_field, 0.0F, *tone_.gain);
  field.black = *tone_.black;
  field.gain = *tone_.gain;
  return field;
}

}  // namespace e2lf::recon
