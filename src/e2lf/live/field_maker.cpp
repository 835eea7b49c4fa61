// SPDX-License-Identifier: MIT
#include "e2lf/live/field_maker.h"

namespace e2lf::live {

Result<void> FieldMaker::make(const capture::Measurement& measurement, size_t samples, std::span<const size_t> views,
                              lightfield::LightField& field) {
  if (!fast_ || samples != samples_) {
    E2LF_ASSIGN_OR_RETURN(fast_, reconstructor_.prepared_for(samples));
    memory_ = {};
    samples_ = samples;
  }
  return fast_->reconstruct_into(measurement, samples, views, memory_, field);
}

Result<void> FieldMaker::make_exactly(const capture::Measurement& measurement, size_t samples,
                                      lightfield::LightField& field) const {
  recon::ReconstructionMemory memory;
  return reconstructor_.reconstruct_into(measurement, samples, {}, memory, field);
}

}  // namespace e2lf::live
