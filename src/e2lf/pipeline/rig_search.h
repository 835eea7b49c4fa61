// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/diagnose/finding.h"
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

}  // namespace e2lf::pipeline
