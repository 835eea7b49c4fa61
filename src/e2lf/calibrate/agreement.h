// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "e2lf/calibrate/fit.h"
#include "e2lf/calibrate/flat_areas.h"

namespace e2lf::calibrate {

/// Means, deviations and correlations of the counts of one cycle.
struct Moments {
  std::vector<double> mean, deviation;  ///< of each transition
  std::vector<double> correlation;      ///< of transitions 1 and 2, 2 and 3, 1 and 3
};

/// How well a model tells the counts of some areas.
struct Agreement {
  double brightness = 0.0;  ///< mean count of the first two transitions
  double x = 0.0, y = 0.0;  ///< the mean place in the field
  double samples = 0.0;
  Moments measured, simulated;
  double total_variation = 0.0;  ///< between the joint histograms: 0 = equal, 1 = apart
  double chance = 0.0;           ///< about what so few samples make of it where the model is true
};

/// The agreement of areas taken together. Deviations and correlations are those within areas, which hold one
/// brightness each.
[[nodiscard]] Agreement agreement_of(const std::vector<const Area*>& areas,
                                     const std::vector<std::vector<double>>& predictions);

struct AgreementReport {
  std::vector<Agreement> rows;    ///< by brightness
  std::vector<Agreement> places;  ///< each area of its own: by brightness, then field position
};

/// The agreement of a camera with areas; each takes the brightness that fits it best. Rows of fewer than 300 samples
/// are left out.
[[nodiscard]] AgreementReport compare(const capture::Camera& camera, const std::vector<float>& open_shares,
                                      const std::vector<Area>& areas);

}  // namespace e2lf::calibrate
