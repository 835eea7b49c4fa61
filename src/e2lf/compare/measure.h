// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/progress.h"
#include "e2lf/compare/plan.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// Loads the light field of a scene in the form in which it is compared: 8x8 grey views, cropped to the middle.
[[nodiscard]] Result<lightfield::LightField> load_scene(const Scene& scene);

/// The outcome of a job.
struct Outcome {
  Json figures;                        ///< a number for each metric, and further data for the page
  lightfield::LightField light_field;  ///< the reconstruction, multiplied by its gain
};

/// Simulates the events of a scene (cycle c of seed s uses the seed s + 1000 c), reconstructs the light field and
/// compares it with the truth. Networks conditioned on the sensor profile receive the sum of all cycles; the results of
/// other methods are averaged over the cycles. Fails as simulation and reconstruction do; the location names method and
/// scene.
[[nodiscard]] Result<Outcome> measure(const Plan& plan, const Job& job, const lightfield::LightField& truth,
                                      const ProgressFn& progress = {});

}  // namespace e2lf::compare
