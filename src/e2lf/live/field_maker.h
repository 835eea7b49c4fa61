// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::live {

/// Reconstructs a sequence of light fields with one network. Each count of a measurement is a sum over `samples`
/// values: cycles of a static scene times pixels of a block. Networks that are not conditioned on the sensor profile
/// receive the mean.
class FieldMaker {
 public:
  /// The input of the network must be event images.
  explicit FieldMaker(recon::Reconstructor reconstructor) : reconstructor_(std::move(reconstructor)) {}

  /// Computes the values of one pass of recon::Reconstructor::reconstruct() into `field`, except for rounding; see
  /// recon::Reconstructor::prepared_for(). Reuses the memory that the first call allocated. The network may compute
  /// only the given views; see reconstruct_into(). Fails as that function does.
  [[nodiscard]] Result<void> make(const capture::Measurement& measurement, size_t samples,
                                  std::span<const size_t> views, lightfield::LightField& field) {
    if (!fast_ || samples != samples_) {
      E2LF_ASSIGN_OR_RETURN(fast_, reconstructor_.prepared_for(samples));
      memory_ = {};
      samples_ = samples;
    }
    return make_with(*fast_, measurement, samples, views, memory_, field);
  }

  /// Computes all views to the bit as reconstruct() does. Any thread may call it.
  [[nodiscard]] Result<void> make_exactly(const capture::Measurement& measurement, size_t samples,
                                          lightfield::LightField& field) const {
    recon::ReconstructionMemory memory;
    return make_with(reconstructor_, measurement, samples, {}, memory, field);
  }

  [[nodiscard]] const recon::Reconstructor& reconstructor() const { return reconstructor_; }

 private:
  [[nodiscard]] static Result<void> make_with(const recon::Reconstructor& network,
                                              const capture::Measurement& measurement, size_t samples,
                                              std::span<const size_t> views, recon::ReconstructionMemory& memory,
                                              lightfield::LightField& field) {
    const lightfield::Shape shape = network.field_shape(measurement);
    if (!(field.shape() == shape)) field = lightfield::LightField::unset(shape);
    return network.reconstruct_into(measurement, samples, views, memory, field);
  }

  recon::Reconstructor reconstructor_;
  std::optional<recon::Reconstructor> fast_;  ///< the network prepared for samples_
  size_t samples_ = 0;
  recon::ReconstructionMemory memory_;
};

}  // namespace e2lf::live
