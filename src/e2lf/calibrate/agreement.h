// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "e2lf/calibrate/fit.h"
#include "e2lf/calibrate/flat_areas.h"

namespace e2lf::calibrate {

/// The means, standard deviations and correlations of the counts of one cycle.
struct Moments {
  std::vector<double> mean, deviation;  ///< one value for each transition
  std::vector<double> correlation;  ///< between transitions 1 and 2, 2 and 3, 1 and 3, then of the pairs 4 and 5, ...
};

/// How well a model predicts the counts of a set of areas.
struct Agreement {
  double brightness = 0.0;  ///< mean count of the first two transitions
  double x = 0.0, y = 0.0;  ///< mean position in the field
  double samples = 0.0;
  Moments measured, simulated;
  double total_variation = 0.0;  ///< mean distance of the joint histograms: 0 = equal, 1 = disjoint
  double chance = 0.0;           ///< approximately its value if the model is true, due to the number of samples
};

struct AgreementReport {
  std::vector<Agreement> rows;    ///< one row for each level of brightness
  std::vector<Agreement> places;  ///< each area by itself, by brightness and then by field position
};

/// Computes the agreement of a camera with areas, each of which gets the brightness that fits it best. Rows of fewer
/// than 300 samples are omitted.
[[nodiscard]] AgreementReport compare(const capture::SensorProfile& camera, const OpenShares& open_shares,
                                      const std::vector<Area>& areas);

}  // namespace e2lf::calibrate
