// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/rig_search.h"

namespace e2lf::pipeline {

/// How the events of a rig are explained if the camera showed certain patterns.
struct PatternFit {
  std::string patterns;  ///< the name of a bundled model, or empty for those that are stated
  OpenedMethod method;
  Explanation explained;
};

/// What the first cycles of events tell of a rig.
struct RigReport {
  size_t cycles = 0;                     ///< number of complete cycles
  double events_per_pixel = 0;           ///< of one cycle
  size_t width = 0, height = 0;          ///< px
  size_t hot = 0, silent = 0;            ///< number of pixels: capture::hot_pixels() and count_silent_pixels()
  std::vector<PatternFit> fits = {};     ///< the best one first; empty if no network fits
  Json changes = Json::object();         ///< see RigSearch
  bool is_confirmed = true;              ///< whether patterns are stated and the times of the cycles are confirmed
  std::optional<Error> no_network = {};  ///< why there are no fits
  diagnose::Findings findings = {};      ///< the most certain mistake first

  /// Returns the verdict of the best fit with all findings, or "unknown" if there is none.
  [[nodiscard]] std::string verdict() const;
};

/// Reads the cycles of `input` and judges the rig: its events, pixels, triggers and schedule, the patterns and the
/// camera that explain the events, and by search_rig() their order, polarity and orientation. If neither the choice nor
/// the events state the patterns, those of each bundled model are tried. The input remains readable for its reports.
/// `on_read` is called when all cycles were read, before the networks run.
/// Fails as CycleInput::next() and search_rig() do.
[[nodiscard]] Result<RigReport> examine_rig(CycleInput& input, MethodChoice choice,
                                            const std::function<void()>& on_read = {});

}  // namespace e2lf::pipeline
