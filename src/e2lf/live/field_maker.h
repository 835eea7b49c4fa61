// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::live {

/// Makes one light field after the other with one network. The counts of measurements are sums over `samples` of one
/// pixel: cycles of a still scene, and pixels of a block. Networks that are not told the camera take their mean.
class FieldMaker {
 public:
  /// The network must take event images.
  explicit FieldMaker(recon::Reconstructor reconstructor) : reconstructor_(std::move(reconstructor)) {}

  /// Computes the values of recon::Reconstructor::reconstruct() in one pass, but for rounding, into `field`, in memory
  /// that is allocated for the first one. The network may compute the given views alone, see reconstruct_into(). Fails
  /// as that function does.
  [[nodiscard]] Result<void> make(const capture::Measurement& measurement, size_t samples,
                                  std::span<const size_t> views, lightfield::LightField& field);

  /// Computes all views to the bit as reconstruct() does. Any thread may call it.
  [[nodiscard]] Result<void> make_exactly(const capture::Measurement& measurement, size_t samples,
                                          lightfield::LightField& field) const;

  [[nodiscard]] const recon::Reconstructor& reconstructor() const { return reconstructor_; }

 private:
  recon::Reconstructor reconstructor_;
  std::optional<recon::Reconstructor> fast_;  ///< for samples_
  size_t samples_ = 0;
  recon::ReconstructionMemory memory_;
};

}  // namespace e2lf::live
