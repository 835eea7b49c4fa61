// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/simulated_cycles.h"

#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/intensity_images.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
Result<capture::Measurement> simulate_cycle(const SimulatedCamera& camera, const lightfield::LightField& scene,
                                            uint64_t cycle) {
  const uint64_t seed = cycle_seed(camera.seed, cycle);
  capture::Measurement measured;
  measured.kind = camera.measurement;
  const capture::SensorProfile& profile = camera.profile;
  if (capture::has_events(measured.kind) && profile.is_pixel()) {
    E2LF_ASSIGN_OR_RETURN(measured.events,
                          sensor::simulate_pixel_events(camera.codes, scene, profile,
                                                        {.gain = camera.gain, .seed = seed, .map_seed = camera.seed}));
  } else if (capture::has_events(measured.kind)) {
    sensor::EventModelOptions options{
        .constants = profile.constants, .gain = camera.gain, .residue = camera.residue, .seed = seed};
    E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(profile.event_model));
    E2LF_ASSIGN_OR_RETURN(measured.events, sensor::simulate_events(camera.codes, scene, options));
  }
  if (measured.kind == capture::MeasurementKind::kEventImages) return measured;
  E2LF_ASSIGN_OR_RETURN(measured.images, sensor::measure_images(measured.kind, camera.codes, scene,
                                                                {profile.constants.sigma_i, camera.gain, seed}));
  return measured;
}

}  // namespace e2lf::pipeline
