// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/simulated_cycles.h"

#include <cmath>

#include "e2lf/depth/disparity_error.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
Result<capture::Measurement> simulate_cycle(const SimulatedCamera& camera, const lightfield::LightField& scene,
                                            uint64_t cycle) {
  const uint64_t seed = camera.seed + cycle;
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

namespace {

using engine::Precision;

/// A simulated cycle of a scene, and what a network should make of it: the views, or the disparities of the middle one.
struct Check {
  capture::Measurement measurement;
  std::vector<float> truth;
};

Result<std::vector<Check>> make_checks(const model::Model& model, std::span<const lightfield::LightField> scenes) {
  SimulatedCamera camera{.measurement = model.measurement(), .codes = *model.codes};
  camera.profile.event_model = model.event_model;
  camera.profile.constants = model.constants;
  if (model.camera) camera.profile = *model.camera;
  std::vector<Check> checks;
  for (const lightfield::LightField& scene : scenes) {
    E2LF_ASSIGN_OR_RETURN(capture::Measurement measurement, simulate_cycle(camera, scene, 0));
    std::vector<float> truth(scene.data().begin(), scene.data().end());
    if (model::is_depth_network(model)) {
      E2LF_ASSIGN_OR_RETURN(depth::TrueDisparity found, depth::true_disparity(scene, std::nullopt));
      truth = std::move(found.disparity.pixels);
    }
    checks.push_back({std::move(measurement), std::move(truth)});
  }
  return checks;
}

/// Returns the sum of squared errors over all scenes.
Result<double> squared_error(const recon::Reconstructor& network, const std::vector<Check>& checks) {
  double sum = 0.0;
  for (const auto& [measurement, truth] : checks) {
    E2LF_ASSIGN_OR_RETURN(const lightfield::LightField field, network.reconstruct(measurement));
    for (size_t i = 0; i < truth.size(); ++i) {
      const double error = static_cast<double>(field.data()[i]) - truth[i];
      sum += error * error;
    }
  }
  return sum;
}

}  // namespace

Result<model::PrecisionLoss> measure_precision_loss(const model::Model& model,
                                                    std::span<const lightfield::LightField> scenes) {
  if (!model.codes) {
    return fail(ErrorCode::kInvalidValue, model.name, "the model has no patterns to simulate; store them in it");
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<Check> checks, make_checks(model, scenes));
  E2LF_ASSIGN_OR_RETURN(const auto exact, recon::Reconstructor::create(model, {.precision = Precision::kFloat32}));
  E2LF_ASSIGN_OR_RETURN(const double exact_error, squared_error(exact, checks));
  model::PrecisionLoss loss;
  for (const auto& [precision, loss_db] :
       {std::pair(Precision::kBfloat16, &loss.bfloat16_db), std::pair(Precision::kInt16, &loss.int16_db)}) {
    const auto rounded = recon::Reconstructor::create(model, {.precision = precision});
    if (!rounded && rounded.error().code == ErrorCode::kUnsupported) continue;
    if (!rounded) return rounded.error();
    E2LF_ASSIGN_OR_RETURN(const double error, squared_error(*rounded, checks));
    *loss_db = std::round(1e4 * 10.0 * std::log10(error / exact_error)) / 1e4;
  }
  return loss;
}

}  // namespace e2lf::pipeline
