// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "e2lf/diagnose/finding.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/field_check.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::pipeline {

/// What a search for a mistake of the rig found.
struct RigSearch {
  Json changes = Json::object();     ///< name of a change -> error of its light field, relative to the unchanged one
  diagnose::Findings findings = {};  ///< the most certain mistake, or a note that the events do not tell
};

/// Searches for a mistake that explains the events of `cycle` better than none: another camera than that of the
/// network, inverted signs, other orders of the event images, and mirrored or turned patterns, each by reconstructing
/// the changed events in a window of at most 192x192 px; and other places of the patterns by the parallax in `sum`,
/// which may contain several cycles of a still scene. `explained` is of the unchanged cycle. The network runs once for
/// each change, which takes as long as a few light fields. Fails as recon::event_error() and the method do.
[[nodiscard]] Result<RigSearch> search_rig(const OpenedMethod& method, const FieldCheck& check,
                                           const Explanation& explained, const capture::EventImages& cycle,
                                           const capture::EventImages& sum);

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
/// Fails as CycleInput::check_transitions(), CycleInput::next() and search_rig() do.
[[nodiscard]] Result<RigReport> examine_rig(CycleInput& input, MethodChoice choice,
                                            const std::function<void()>& on_read = {});

}  // namespace e2lf::pipeline
