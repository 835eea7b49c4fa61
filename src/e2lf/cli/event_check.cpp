// SPDX-License-Identifier: MIT
#include "e2lf/cli/event_check.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::cli {
namespace {

constexpr int kResidues = 4;  // parts of a threshold that are tried, beside none

/// Raises the first intensities until their logarithms are `residue` thresholds higher: the references start there.
void raise_references(const sensor::CodedIntensities& original, const sensor::EventModelOptions& options,
                      double residue, sensor::CodedIntensities& intensities) {
  const auto factor = static_cast<float>(std::exp(residue * static_cast<double>(options.constants.tau)));
  const float eps = options.constants.eps, gain = options.gain;
  const auto raise = [=](float value) { return ((std::max(gain * value, 0.0F) + eps) * factor - eps) / gain; };
  std::ranges::transform(original.image(0), intensities.image(0).begin(), raise);
}

}  // namespace

Result<EventError> event_error(const KnownCodes& known, const lightfield::LightField& light_field, float gain,
                               const events::EventImages& given) {
  if (known.codes.num_patterns != given.transitions + 1) {
    return Error{ErrorCode::kShape,
                 cat("the codes have ", known.codes.num_patterns, " patterns, the events ", given.transitions,
                     " transitions; give the codes that the events were made with"),
                 "--codes"};
  }
  sensor::EventModelOptions options;
  E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(known.event_model));
  options.constants = known.constants;
  options.gain = 1.0F / gain;
  options.constants.sigma_w = options.constants.sigma_z = 0.0F;
  E2LF_ASSIGN_OR_RETURN(const auto original, sensor::coded_intensities(known.codes, light_field));
  E2LF_ASSIGN_OR_RETURN(const auto at_first, sensor::simulate_events(original, options));
  EventError error;
  error.at_first = error.least = eval::mean_event_difference(at_first, given);
  sensor::CodedIntensities intensities = original;
  for (int part = 1; part <= kResidues; ++part) {
    const double residue = static_cast<double>(part) / kResidues;
    raise_references(original, options, residue, intensities);
    E2LF_ASSIGN_OR_RETURN(const auto simulated, sensor::simulate_events(intensities, options));
    const double value = eval::mean_event_difference(simulated, given);
    if (value >= error.least) continue;
    error.least = value;
    error.residue = residue;
  }
  return error;
}

}  // namespace e2lf::cli
