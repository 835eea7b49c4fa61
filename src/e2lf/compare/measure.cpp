// SPDX-License-Identifier: MIT
#include "e2lf/compare/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/compare/view_scan.h"
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
#include "e2lf/sensor/intensity_images.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::compare {
namespace {

using capture::EventImages;
using lightfield::LightField;

constexpr double kViewsOfPaper = 64;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Result<EventImages> simulate_events(const ComparedMethod& method, const Sensor& sensor, const LightField& scene,
                                    uint64_t seed, uint64_t cycle_seed) {
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

Result<capture::Measurement> simulate(const ComparedMethod& method, const Sensor& sensor, const LightField& scene,
                                      uint64_t seed, size_t cycle) {
  const uint64_t cycle_seed = seed + 1000 * cycle;
  capture::Measurement measured;
  measured.kind = method.measurement;
  if (capture::has_events(method.measurement)) {
    E2LF_ASSIGN_OR_RETURN(measured.events, simulate_events(method, sensor, scene, seed, cycle_seed));
  }
  const sensor::ImageOptions options{sensor.camera.constants.sigma_i, sensor.config.gain, cycle_seed};
  E2LF_ASSIGN_OR_RETURN(measured.images, sensor::measure_images(method.measurement, method.codes, scene, options));
  return measured;
}

/// Returns the sum of the events and the mean of the images of several cycles.
capture::Measurement sum_of(const std::vector<capture::Measurement>& cycles) {
  capture::Measurement all = cycles.front();
  std::vector<int16_t>& counts = all.events.counts;
  for (size_t i = 1; i < cycles.size(); ++i) {
    for (size_t k = 0; k < counts.size(); ++k) {
      counts[k] = static_cast<int16_t>(std::clamp(counts[k] + cycles[i].events.counts[k], INT16_MIN, INT16_MAX));
    }
    for (size_t k = 0; k < all.images.values.size(); ++k) all.images.values[k] += cycles[i].images.values[k];
  }
  for (float& value : all.images.values) value /= static_cast<float>(cycles.size());
  return all;
}

/// Makes a light field from the measurement of one cycle, or from the sum of several.
using Reconstruct =
    std::function<Result<LightField>(const capture::Measurement& measured, size_t cycles, const ProgressFn& progress)>;

struct Algorithm {
  Reconstruct reconstruct;
  bool takes_sums = false;
};

Result<Algorithm> algorithm_of(const ComparedMethod& method, const Sensor& sensor) {
  if (method.config.algorithm == "regularised") {
    return Algorithm{[&](const capture::Measurement& measured, size_t, const ProgressFn& progress) {
                       return recon::reconstruct_regularised(measured.events, method.codes, sensor.camera.constants, {},
                                                             progress);
                     },
                     false};
  }
  if (method.config.algorithm == "inversion") {
    return Algorithm{[&](const capture::Measurement& measured, size_t, const ProgressFn&) {
                       return recon::reconstruct_by_inversion(measured.events, method.codes, sensor.camera.constants);
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
  return Algorithm{[shared, passes](const capture::Measurement& measured, size_t cycles, const ProgressFn& progress) {
                     return shared->reconstruct(measured, progress, passes, cycles);
                   },
                   is_told};
}

Result<LightField> reconstruct(const Algorithm& algorithm, const std::vector<capture::Measurement>& cycles,
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

/// The bits per pixel of an intensity image, as counted in the paper.
constexpr double kBitsPerIntensity = 8;

/// Returns for how long the patterns that contribute to the measurement are shown. The paper's camera records events
/// after the first pattern; methods that use images expose all patterns.
double measured_us(const ComparedMethod& method, const cycles::Schedule& schedule) {
  double events_us = 0, pattern_us = 0;
  for (const cycles::ScheduledPattern& pattern : schedule.patterns) {
    if (!pattern.image) continue;
    pattern_us = static_cast<double>(pattern.interval_us());
    events_us += pattern_us;
  }
  if (method.measurement == capture::MeasurementKind::kEventImages) return events_us;
  return pattern_us * static_cast<double>(method.codes.num_patterns);
}

/// Adds the mean events of each transition over the cycles, and the total cost of all cycles.
void add_costs(const ComparedMethod& method, const std::vector<capture::Measurement>& cycles, Json& figures) {
  const auto count = static_cast<double>(cycles.size());
  std::vector<double> per_transition(cycles.front().events.transitions);
  double total = 0;
  for (const capture::Measurement& measured : cycles) {
    if (per_transition.empty()) break;
    const eval::EventStatistics statistics = eval::event_statistics(measured.events);
    total += statistics.total_events_per_pixel;
    for (size_t k = 0; k < per_transition.size(); ++k) per_transition[k] += statistics.events_per_pixel[k] / count;
  }
  const cycles::Schedule schedule = cycles::paper_schedule(std::max<size_t>(method.codes.num_patterns, 2));
  const double image_bits =
      count * kBitsPerIntensity * static_cast<double>(cycles.front().images.num_patterns) / kViewsOfPaper;
  figures["events_per_pixel"] = total;
  figures["bits_per_pixel"] = eval::event_cost(total).bits_per_light_field_pixel + image_bits;
  figures["measurement_ms"] = count * measured_us(method, schedule) / 1000;
  if (!per_transition.empty()) figures["cycle_ms"] = count * static_cast<double>(schedule.cycle_us()) / 1000;
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

/// Runs a method and returns the reconstruction with its cost, without the figures that depend on its gain.
Result<Outcome> run_method(const ComparedMethod& method, const Sensor& sensor, uint64_t seed, const LightField& truth,
                           const ProgressFn& progress) {
  using Clock = std::chrono::steady_clock;
  std::vector<capture::Measurement> cycles;
  for (size_t cycle = 0; cycle < sensor.config.cycles; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(capture::Measurement measured, simulate(method, sensor, truth, seed, cycle));
    cycles.push_back(std::move(measured));
  }
  E2LF_ASSIGN_OR_RETURN(const Algorithm algorithm, algorithm_of(method, sensor));
  Outcome measurement;
  const Clock::time_point begin = Clock::now();
  E2LF_ASSIGN_OR_RETURN(measurement.light_field, reconstruct(algorithm, cycles, progress));
  measurement.figures["reconstruct_s"] = std::chrono::duration<double>(Clock::now() - begin).count();
  add_costs(method, cycles, measurement.figures);
  // Lenses at the edge extend beyond the scene.
  const lightfield::Shape &shape = truth.shape(), &found = measurement.light_field.shape();
  if (found.height != shape.height || found.width != shape.width) {
    E2LF_ASSIGN_OR_RETURN(measurement.light_field,
                          lightfield::crop(measurement.light_field, {0, 0, shape.height, shape.width}));
  }
  return measurement;
}

/// Runs a network that makes frames while the views are scanned.
Result<Outcome> run_scan(const ComparedMethod& method, const Sensor& sensor, uint64_t seed, const LightField& truth,
                         const ProgressFn& progress) {
  if (sensor.camera.is_pixel() || sensor.config.cycles > 1) {
    return Error{ErrorCode::kUnsupported,
                 "a scan is simulated once, by pixels of v2e with the sensor's tau; leave this method out for sensors "
                 "with physical pixels or several cycles",
                 ""};
  }
  E2LF_ASSIGN_OR_RETURN(const model::VideoModel model, model::read_video_model(method.model));
  const ScanOptions options{.tau = sensor.camera.constants.tau, .gain = sensor.config.gain, .seed = seed};
  E2LF_ASSIGN_OR_RETURN(ScanResult scan, scan_to_light_field(model, truth, options, progress));
  Outcome measurement;
  measurement.light_field = std::move(scan.light_field);
  measurement.figures = {{"reconstruct_s", scan.reconstruct_s},
                         {"events_per_pixel", scan.events_per_pixel},
                         {"bits_per_pixel", eval::event_cost(scan.events_per_pixel).bits_per_light_field_pixel},
                         {"measurement_ms", scan.measurement_ms},
                         {"cycle_ms", scan.measurement_ms}};
  return measurement;
}

Result<Outcome> measure_unnamed(const Plan& plan, const Job& job, const LightField& truth, const ProgressFn& progress) {
  const ComparedMethod& method = plan.methods[job.method];
  const Sensor& sensor = plan.sensors[job.sensor];
  const auto run = is_scan(method) ? run_scan : run_method;
  E2LF_ASSIGN_OR_RETURN(Outcome measurement, run(method, sensor, job.seed, truth, progress));
  LightField& field = measurement.light_field;
  // The frames have no absolute scale.
  const bool is_fitted = method.config.fit_gain || sensor.config.fit_gain || is_scan(method);
  const float gain = is_fitted ? eval::best_gain(truth, field) : method.config.gain / sensor.config.gain;
  for (float& value : field.data()) value *= gain;
  E2LF_ASSIGN_OR_RETURN(const eval::LightFieldMetrics quality, eval::compare(truth, field));
  add_quality(quality, measurement.figures);
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

Result<Outcome> measure(const Plan& plan, const Job& job, const LightField& truth, const ProgressFn& progress) {
  auto measured = measure_unnamed(plan, job, truth, progress);
  if (measured) return measured;
  Error error = measured.error();
  error.location = cat(plan.methods[job.method].config.name, " on ", plan.scenes[job.scene].name, ", sensor ",
                       plan.sensors[job.sensor].config.name, error.location.empty() ? "" : ": ", error.location);
  return error;
}

}  // namespace e2lf::compare
