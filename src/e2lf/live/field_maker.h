// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/input.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::live {

/// Makes one light field after the other with one network, in memory that is allocated for the first one.
class FieldMaker {
 public:
  /// The network must take event images.
  explicit FieldMaker(recon::Reconstructor reconstructor) : reconstructor_(std::move(reconstructor)) {}

  /// Computes the same values as recon::Reconstructor::reconstruct() in one pass, into `field`. The counts of
  /// `measurement` are sums over `samples` of one pixel: cycles of a still scene, and pixels of a block. Networks that
  /// are not told the camera take their mean. Fails as that function does.
  [[nodiscard]] Result<void> make(const capture::Measurement& measurement, size_t samples,
                                  lightfield::LightField& field);

  [[nodiscard]] const recon::Reconstructor& reconstructor() const { return reconstructor_; }

 private:
  recon::Reconstructor reconstructor_;
  recon::InputPlanes input_;
  std::vector<float> uncropped_;  ///< for images whose size is no multiple of the network's
};

}  // namespace e2lf::live
