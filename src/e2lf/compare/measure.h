// SPDX-License-Identifier: MIT
#pragma once

#include <list>
#include <map>
#include <utility>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/compare/plan.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/video/video_model.h"

namespace e2lf::compare {

/// Loads the light field of a scene in the form in which it is compared: 8x8 grey views, cropped to the middle.
[[nodiscard]] Result<lightfield::LightField> load_scene(const ComparedScene& scene);

/// Returns the true disparities of the middle view of a scene: those rendered, those of the file beside the scene
/// (depth::find_true_disparity()), cropped as the scene is, or else those that depth::estimate_disparity() finds in
/// `truth`, the result of load_scene(). It is empty if depth::has_comparable_disparity() is false. Fails with kShape
/// (the file has another size) and as reading does.
[[nodiscard]] Result<lightfield::Image> scene_disparity(const ComparedScene& scene,
                                                        const lightfield::LightField& truth);

/// The outcome of a job.
struct Outcome {
  Json figures;                        ///< a number for each metric, and further data for the page
  lightfield::LightField light_field;  ///< the reconstruction, multiplied by its gain
  lightfield::Image disparity;         ///< of its middle view; empty if there is no true one
};

/// Runs the jobs of a plan. Prepared methods are kept for all their jobs with a sensor, and what is simulated is kept
/// for all methods with the same patterns, until a job has another scene or sensor.
class JobRunner {
 public:
  explicit JobRunner(const Plan& plan) : plan_(plan) {}

  /// Simulates the events of a scene (see pipeline::simulate_cycle()), reconstructs the light field and compares it
  /// with the truth. Networks conditioned on the sensor profile receive the sum of all cycles; the results of other
  /// methods are averaged over the cycles. The figure `saturated_events` counts the events for which sums had no room.
  /// The disparities of the result are compared with `disparity` unless it is empty.
  /// Fails as simulation and reconstruction do; the location names method and scene.
  [[nodiscard]] Result<Outcome> run(const Job& job, const lightfield::LightField& truth,
                                    const lightfield::Image& disparity = {}, const ProgressFn& progress = {});

  /// Returns how many measurements were simulated and how many methods were prepared so far.
  [[nodiscard]] size_t num_simulated() const { return num_simulated_; }
  [[nodiscard]] size_t num_prepared() const { return methods_.size(); }

 private:
  using Cycles = std::vector<capture::Measurement>;
  struct Simulated {
    capture::Codes codes;
    capture::MeasurementKind kind;
    uint64_t seed;
    Cycles cycles;
  };

  Result<Outcome> run_method(const Job& job, const lightfield::LightField& truth, const ProgressFn& progress);
  Result<Outcome> run_program(const Job& job, const lightfield::LightField& truth);
  Result<Outcome> run_scan(const Job& job, const lightfield::LightField& truth, const ProgressFn& progress);
  Result<const pipeline::OpenedMethod*> method_of(const Job& job);
  Result<const Cycles*> cycles_of(const Job& job, const lightfield::LightField& truth);

  const Plan& plan_;
  std::map<std::pair<size_t, size_t>, pipeline::OpenedMethod> methods_;  ///< keys are the numbers of method and sensor
  std::map<size_t, video::VideoModel> scans_;                            ///< keys are the numbers of the methods
  std::list<Simulated> simulated_;   ///< measurements of the current scene and sensor
  std::pair<size_t, size_t> place_;  ///< their numbers
  size_t num_simulated_ = 0;
};

}  // namespace e2lf::compare
