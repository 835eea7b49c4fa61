// SPDX-License-Identifier: MIT
#include "e2lf/recon/field_sequence.h"

#include <chrono>
#include <memory>

#include "e2lf/recon/gain.h"

namespace e2lf::recon {

Method network_method(Reconstructor reconstructor, size_t passes, size_t cycles) {
  const auto shared = std::make_shared<Reconstructor>(std::move(reconstructor));
  return [shared, passes, cycles](const capture::EventImages& images, const ProgressFn& progress) {
    return shared->reconstruct(images, progress, passes, cycles);
  };
}

Result<Field> FieldSequence::next(const capture::EventImages& images, const ProgressFn& progress) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Field field;
  E2LF_ASSIGN_OR_RETURN(field.light_field, method_(images, progress));
  field.reconstruct_s = std::chrono::duration<double>(Clock::now() - begin).count();
  if (!gain_) gain_ = auto_gain(field.light_field);
  field.gain = *gain_;
  if (field.gain != 1.0F) {
    for (float& value : field.light_field.data()) value *= field.gain;
  }
  if (check_) {
    E2LF_ASSIGN_OR_RETURN(field.error, event_error(*check_, field.light_field, field.gain, images));
  }
  return field;
}

}  // namespace e2lf::recon
