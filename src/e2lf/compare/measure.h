// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/progress.h"
#include "e2lf/compare/plan.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// The light field of a scene as it is compared: 8x8 grey views, the middle part.
[[nodiscard]] Result<lightfield::LightField> load_scene(const Scene& scene);

/// What a job found.
struct Measurement {
  Json figures;                        ///< a number for each metric, and what the page shows
  lightfield::LightField light_field;  ///< the reconstruction at its gain
};

/// Simulates the events of a scene (cycle c of seed s has the seed s + 1000 c), reconstructs it and compares. Networks
/// that are told the camera get the sum of all cycles; the results of other methods are averaged over them. Fails as
/// simulation and reconstruction do, naming method and scene.
[[nodiscard]] Result<Measurement> measure(const Plan& plan, const Job& job, const lightfield::LightField& truth,
                                          const ProgressFn& progress = {});

}  // namespace e2lf::compare
