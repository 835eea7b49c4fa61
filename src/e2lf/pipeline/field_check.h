// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/diagnose/finding.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/recon/event_check.h"

namespace e2lf::pipeline {

/// How well a light field explains its events.
struct Explanation {
  double error = 0;        ///< recon::EventError::least in the middle of the image
  double noise_error = 0;  ///< the same for events simulated from the light field with the noise of the camera
  double ratio = 0;        ///< error / noise_error: the same scale for dark and bright scenes and for all cameras
  double contrast = 0;     ///< of the middle view without its noise: (bright - dark) / (bright + dark), 0 to 1
  diagnose::Findings findings = {};

  /// Returns "good", "usual", "unconfirmed" or, if there is a finding of a warning or an error, "doubtful".
  [[nodiscard]] std::string verdict(bool is_confirmed) const;
  [[nodiscard]] Json json(bool is_confirmed) const;
};

/// Returns the same camera for a window in the middle of the image.
[[nodiscard]] recon::EventCheck in_window(recon::EventCheck check, double share_of_width);

/// Compares light fields with the events from which they were reconstructed. No ground truth is needed.
class FieldCheck {
 public:
  /// Checks light fields from sums over `cycles`. Returns nothing if the patterns are unknown or if colours are
  /// reconstructed separately.
  [[nodiscard]] static Result<std::optional<FieldCheck>> create(const OpenedMethod& method, size_t cycles = 1);

  /// Computes recon::event_error() of an unprocessed light field. `is_of_lit` is that of Field.
  [[nodiscard]] Result<recon::EventError> compare(const lightfield::LightField& light_field,
                                                  const capture::EventImages& events, bool is_of_lit) const;

  /// Judges an unprocessed light field in a window of at most 512x512 px in the middle of the image. Returns nothing if
  /// the method does not use the sensor profile, because its error then does not depend on polarity and order. Fails as
  /// recon::event_error() does.
  [[nodiscard]] Result<std::optional<Explanation>> judge(const lightfield::LightField& light_field,
                                                         const capture::EventImages& events, bool is_of_lit) const;

  /// Reconstructs the middle of the image, at most 512x512 px, and judges it. Fails as judge() and the method do.
  [[nodiscard]] Result<std::optional<Explanation>> judge_events(const capture::EventImages& events) const;

  /// The method, in one pass, and the camera with which its light fields are compared.
  [[nodiscard]] const recon::Method& method() const { return own_.method; }
  [[nodiscard]] const recon::EventCheck& camera() const { return own_.check; }

 private:
  /// A method and the camera with which its light fields are compared.
  struct Candidate {
    recon::Method method;
    recon::EventCheck check;
  };

  [[nodiscard]] const Candidate& candidate(bool is_of_lit) const { return is_of_lit && lit_ ? *lit_ : own_; }

  Candidate own_;
  std::optional<Candidate> lit_;  ///< for the lit transitions of cycles with motion
  bool is_judged_ = false;
};

}  // namespace e2lf::pipeline
