// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/diagnose/finding.h"

namespace e2lf::diagnose {

/// A mistake in the signs or the order of event images, as the change that undoes it.
struct EventChange {
  const char* code;                 ///< of its finding: "polarity-inverted" or "order-better-changed"
  std::string name;                 ///< such as "with inverted polarity"
  std::string remedy, option = {};  ///< as of Finding
  std::vector<size_t> order = {};   ///< image k becomes image order[k]; empty if all counts are negated

  [[nodiscard]] capture::EventImages apply(const capture::EventImages& events) const;
};

/// Returns the changes that are searched: inverted polarity, and images that were rotated, exchanged with the next one,
/// or reversed.
[[nodiscard]] std::vector<EventChange> event_changes(size_t transitions);

/// Compares event images, which may be sums over several `cycles`, with those of grey surfaces of any brightness in
/// front of the same camera. Averaged over blocks of pixels, parallax hardly counts, so that the counts of all
/// transitions follow from the brightness alone. If they do so only after a change of their signs or their order, this
/// change is the finding. No network is used. Returns nothing unless `setup` states the patterns and the camera,
/// unless these fit the images, and for scenes that are too dark or too small.
[[nodiscard]] std::optional<Finding> check_order(const capture::EventImages& events, size_t cycles,
                                                 const capture::RecordedSetup& setup);

}  // namespace e2lf::diagnose
