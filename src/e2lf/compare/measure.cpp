// SPDX-License-Identifier: MIT
#include "e2lf/compare/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/capture/codes_io.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/eval/best_gain.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/lightfield/crop.h"
#include "e2lf/lightfield/demo_scene.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/recon/linear_estimate.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/recon/regularised.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::compare {
namespace {

using capture::EventImages;
using lightfield::LightField;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Result<EventImages> simulate(const Method& method, const Sensor& sensor, const LightField& scene, uint64_t seed,
                             size_t cycle) {
  const uint64_t cycle_seed = seed + 1000 * cycle;
  const SensorConfig& config = sensor.config;
  if (sensor.camera.is_pixel()) {
    return sensor::simulate_pixel_events(method.codes, scene, sensor.camera,
                                         {.gain = config.gain, .seed = cycle_seed, .map_seed = seed});
  }
  sensor::EventModelOptions options;
  E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(sensor.camera.event_model));
  options.constants = sensor.camera.constants;
  options.gain = config.gain;
  options.residue = config.residue;
  options.seed = cycle_seed;
  return sensor::simulate_events(method.codes, scene, options);
}

EventImages sum_of(const std::vector<EventImages>& cycles) {
  EventImages sum = cycles.front();
  for (size_t i = 1; i < cycles.size(); ++i) {
    for (size_t k = 0; k < sum.counts.size(); ++k) {
      sum.counts[k] = static_cast<int16_t>(std::clamp(sum.counts[k] + cycles[i].counts[k], INT16_MIN, INT16_MAX));
    }
  }
  return sum;
}

/// Makes a light field of the event images of a cycle, or of the sum of several.
using Reconstruct =
    std::function<Result<LightField>(const EventImages& images, size_t cycles, const ProgressFn& progress)>;

struct Algorithm {
  Reconstruct reconstruct;
  bool takes_sums = false;
};

Result<Algorithm> algorithm_of(const Method& method, const Sensor& sensor) {
  if (method.config.algorithm == "regularised") {
    return Algorithm{[&](const EventImages& images, size_t, const ProgressFn& progress) {
                       return recon::reconstruct_regularised(images, method.codes, sensor.camera.constants, {},
                                                             progress);
                     },
                     false};
  }
  if (method.config.algorithm == "inversion") {
    return Algorithm{[&](const EventImages& images, size_t, const ProgressFn&) {
                       return recon::reconstruct_by_inversion(images, method.codes, sensor.camera.constants);
                     },
                     false};
  }
  std::error_code error;
  const bool is_release = std::filesystem::is_directory(method.model, error);
  E2LF_ASSIGN_OR_RETURN(model::Model model,
                        is_release ? model::import_release(method.model) : model::read_model(method.model));
  const bool is_told = model::is_told_the_camera(model);
  if (is_told) model.camera = method.told.value_or(sensor.camera);
  E2LF_ASSIGN_OR_RETURN(const auto precision, engine::precision_from_name(method.config.precision));
  E2LF_ASSIGN_OR_RETURN(auto network, recon::Reconstructor::create(std::move(model), {.precision = precision}));
  const auto shared = std::make_shared<recon::Reconstructor>(std::move(network));
  const size_t passes = method.config.passes;
  return Algorithm{[shared, passes](const EventImages& images, size_t cycles, const ProgressFn& progress) {
                     return shared->reconstruct(images, progress, passes, cycles);
                   },
                   is_told};
}

Result<LightField> reconstruct(const Algorithm& algorithm, const std::vector<EventImages>& cycles,
                               const ProgressFn& progress) {
  if (algorithm.takes_sums) return algorithm.reconstruct(sum_of(cycles), cycles.size(), progress);
  LightField mean;
  for (size_t i = 0; i < cycles.size(); ++i) {
    const ProgressFn part = [&](size_t done, size_t total) {
      if (progress) progress(i * total + done, cycles.size() * total);
    };
    E2LF_ASSIGN_OR_RETURN(LightField field, algorithm.reconstruct(cycles[i], 1, part));
    if (i == 0) {
      mean = std::move(field);
      continue;
    }
    for (size_t k = 0; k < field.data().size(); ++k) mean.data()[k] += field.data()[k];
  }
  if (cycles.size() > 1) {
    for (float& value : mean.data()) value /= static_cast<float>(cycles.size());
  }
  return mean;
}

/// Means over the cycles of the events of each transition, and what all cycles together cost.
void add_costs(const std::vector<EventImages>& cycles, Json& figures) {
  const size_t num_patterns = cycles.front().transitions + 1;
  std::vector<double> per_transition(cycles.front().transitions);
  double total = 0;
  for (const EventImages& images : cycles) {
    const eval::EventStatistics statistics = eval::event_statistics(images);
    total += statistics.total_events_per_pixel;
    for (size_t k = 0; k < per_transition.size(); ++k) {
      per_transition[k] += statistics.events_per_pixel[k] / static_cast<double>(cycles.size());
    }
  }
  const cycles::Schedule schedule = cycles::paper_schedule(num_patterns);
  double measured_us = 0;
  for (const cycles::ScheduledPattern& pattern : schedule.patterns) {
    if (pattern.image) measured_us += static_cast<double>(pattern.interval_us());
  }
  const auto count = static_cast<double>(cycles.size());
  figures["events_per_pixel"] = total;
  figures["bits_per_pixel"] = eval::event_cost(total).bits_per_light_field_pixel;
  figures["measurement_ms"] = count * measured_us / 1000;
  figures["cycle_ms"] = count * static_cast<double>(schedule.cycle_us()) / 1000;
  figures["events_per_transition"] = per_transition;
}

void add_quality(const eval::LightFieldMetrics& quality, Json& figures) {
  figures["psnr_db"] = number(quality.mean.psnr_db);
  figures["ssim"] = number(quality.mean.ssim_uniform7);
  figures["ssim_gaussian"] = number(quality.mean.ssim_gaussian);
  figures["epi_error"] = number(quality.epi.relative);
  figures["views_psnr_db"] = Json::array();
  for (const auto& view : quality.views) figures["views_psnr_db"].push_back(number(view.metrics.psnr_db));
}

Result<Measurement> measure_unnamed(const Plan& plan, const Job& job, const LightField& truth,
                                    const ProgressFn& progress) {
  using Clock = std::chrono::steady_clock;
  const Method& method = plan.methods[job.method];
  const Sensor& sensor = plan.sensors[job.sensor];
  std::vector<EventImages> cycles;
  for (size_t cycle = 0; cycle < sensor.config.cycles; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(EventImages images, simulate(method, sensor, truth, job.seed, cycle));
    cycles.push_back(std::move(images));
  }
  E2LF_ASSIGN_OR_RETURN(const Algorithm algorithm, algorithm_of(method, sensor));
  Measurement measurement;
  const Clock::time_point begin = Clock::now();
  E2LF_ASSIGN_OR_RETURN(measurement.light_field, reconstruct(algorithm, cycles, progress));
  const double reconstruct_s = std::chrono::duration<double>(Clock::now() - begin).count();
  LightField& field = measurement.light_field;
  const bool is_fitted = method.config.fit_gain || sensor.config.fit_gain;
  const float gain = is_fitted ? eval::best_gain(truth, field) : method.config.gain / sensor.config.gain;
  for (float& value : field.data()) value *= gain;
  E2LF_ASSIGN_OR_RETURN(const eval::LightFieldMetrics quality, eval::compare(truth, field));
  add_quality(quality, measurement.figures);
  add_costs(cycles, measurement.figures);
  measurement.figures["reconstruct_s"] = reconstruct_s;
  measurement.figures["gain"] = json_number(gain);
  measurement.figures["num_patterns"] = method.codes.num_patterns;
  measurement.figures["patterns"] = capture::codes_to_json(method.codes)["patterns"];
  return measurement;
}

}  // namespace

Result<LightField> load_scene(const Scene& scene) {
  const GroupConfig& group = scene.group;
  if (scene.rendered_seed) {
    const size_t width = group.width > 0 ? group.width : 512, height = group.height > 0 ? group.height : 384;
    return lightfield::render_light_field(lightfield::demo_scene(*scene.rendered_seed), {8, 8, height, width, 1});
  }
  lightfield::ReadOptions options;
  options.views_y.step = options.views_x.step = group.step;
  options.reverse_rows = group.reverse_rows;
  E2LF_ASSIGN_OR_RETURN(LightField field, lightfield::read_light_field(scene.path, options));
  const lightfield::Shape& shape = field.shape();
  const size_t height = group.height > 0 ? std::min(group.height, shape.height) : shape.height;
  const size_t width = group.width > 0 ? std::min(group.width, shape.width) : shape.width;
  if (height == shape.height && width == shape.width) return field;
  return lightfield::crop(field, {(shape.height - height) / 2, (shape.width - width) / 2, height, width});
}

Result<Measurement> measure(const Plan& plan, const Job& job, const LightField& truth, const ProgressFn& progress) {
  auto measured = measure_unnamed(plan, job, truth, progress);
  if (measured) return measured;
  Error error = measured.error();
  error.location = cat(plan.methods[job.method].config.name, " on ", plan.scenes[job.scene].name, ", sensor ",
                       plan.sensors[job.sensor].config.name, error.location.empty() ? "" : ": ", error.location);
  return error;
}

}  // namespace e2lf::compare
