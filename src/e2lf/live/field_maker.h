// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/input.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::live {

/// Reconstructs a sequence of light fields with one network and reuses the memory that the first one allocated.
class FieldMaker {
 public:
  /// The input of the network must be event images.
  explicit FieldMaker(recon::Reconstructor reconstructor) : reconstructor_(std::move(reconstructor)) {}

  /// Computes the same values as one pass of recon::Reconstructor::reconstruct() and stores them in `field`. Each count
  /// of `measurement` is a sum over `samples` values: cycles of a static scene times pixels of a block. Networks that
  /// are not conditioned on the sensor profile receive the mean. Fails as recon::Reconstructor::reconstruct() does.
  [[nodiscard]] Result<void> make(const capture::Measurement& measurement, size_t samples,
                                  lightfield::LightField& field);

  [[nodiscard]] const recon::Reconstructor& reconstructor() const { return reconstructor_; }

 private:
  recon::Reconstructor reconstructor_;
  recon::InputPlanes input_;
  std::vector<float> uncropped_;  ///< for image sizes that are not a multiple of the network's block size
};

}  // namespace e2lf::live
