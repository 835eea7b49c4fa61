// SPDX-License-Identifier: MIT
#include "e2lf/compare/measure.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/compare/view_scan.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/simulated_cycles.h"

namespace e2lf::compare {
namespace fs = std::filesystem;
namespace {

using lightfield::LightField;

constexpr double kViewsOfPaper = 64;

/// The sum of the events and the mean of the images of several cycles.
struct Sum {
  capture::Measurement measured;
  uint64_t saturated = 0;  ///< events for which the sum has no room
};

Sum sum_of(const std::vector<capture::Measurement>& cycles) {
  Sum sum{cycles.front()};
  std::vector<float>& values = sum.measured.images.values;
  for (size_t i = 1; i < cycles.size(); ++i) {
    sum.saturated += pipeline::add_counts(cycles[i].events, sum.measured.events);
    for (size_t k = 0; k < values.size(); ++k) values[k] += cycles[i].images.values[k];
  }
  for (float& value : values) value /= static_cast<float>(cycles.size());
  return sum;
}

/// Returns the mean of the light fields of the cycles.
Result<LightField> reconstruct_each(const recon::Method& method, const std::vector<capture::Measurement>& cycles,
                                    const ProgressFn& progress) {
  LightField mean;
  for (size_t i = 0; i < cycles.size(); ++i) {
    E2LF_ASSIGN_OR_RETURN(LightField field, method(cycles[i], progress_of_pass(progress, i, cycles.size())));
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

void add_costs(const ComparedMethod& method, const std::vector<capture::Measurement>& cycles, Json& figures) {
  const auto count = static_cast<double>(cycles.size());
  double total = 0;
  const bool has_events = cycles.front().events.count > 0;
  for (const capture::Measurement& measured : cycles) {
    if (has_events) total += eval::event_statistics(measured.events).total_events_per_pixel;
  }
  const cycles::Schedule schedule = cycles::paper_schedule(std::max<size_t>(method.codes.num_patterns, 2));
  const double image_bits =
      count * kBitsPerIntensity * static_cast<double>(cycles.front().images.count) / kViewsOfPaper;
  figures["events_per_pixel"] = total;
  figures["bits_per_pixel"] = eval::event_cost(total).bits_per_light_field_pixel + image_bits;
  figures["measurement_ms"] = count * measured_us(method, schedule) / 1000;
  if (has_events) figures["cycle_ms"] = count * static_cast<double>(schedule.cycle_us()) / 1000;
}

void add_quality(const eval::LightFieldMetrics& quality, Json& figures) {
  figures["psnr_db"] = finite_or_null(quality.mean.psnr_db);
  figures["ssim"] = finite_or_null(quality.mean.ssim_uniform7);
  figures["ssim_gaussian"] = finite_or_null(quality.mean.ssim_gaussian);
  figures["epi_error"] = finite_or_null(quality.epi.relative);
  figures["views_psnr_db"] = Json::array();
  for (const auto& view : quality.views) figures["views_psnr_db"].push_back(finite_or_null(view.metrics.psnr_db));
}

Result<void> add_disparity(const lightfield::Image& truth, Outcome& outcome) {
  if (truth.pixels.empty()) return {};
  E2LF_ASSIGN_OR_RETURN(depth::FoundDisparity found, depth::judge_disparity(outcome.light_field, truth));
  outcome.figures["bad_07_percent"] = found.error.bad_07_percent;
  outcome.figures["bad_20_percent"] = found.error.bad_20_percent;
  outcome.figures["disparity_error_px"] = found.error.mean_absolute_px;
  outcome.figures["disparity_slope"] = found.error.slope;
  outcome.disparity = std::move(found.disparity);
  return {};
}

Result<pid_t> start(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);  // stdout holds the results of e2lf
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, arguments.front(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return child;
  return fail(ErrorCode::kNotFound, words.front(), "the program cannot be started (", std::strerror(error),
              "); correct the command");
}

Result<void> wait_for(pid_t child, const std::string& program) {
  constexpr auto kPoll = std::chrono::milliseconds(10);
  constexpr int kPatience = 500;  // polls from the request to stop until the program is killed
  int status = 0, polls = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (stop_requested()) ::kill(child, ++polls > kPatience ? SIGKILL : SIGTERM);
    std::this_thread::sleep_for(kPoll);
  }
  if (stop_requested()) return fail(ErrorCode::kCancelled, program, "the program was stopped");
  if (WIFSIGNALED(status)) {
    return fail(ErrorCode::kUnsupported, program, "the program was ended by signal ", WTERMSIG(status),
                "; run it alone with the events of one scene");
  }
  if (WEXITSTATUS(status) == 0) return {};
  return fail(ErrorCode::kUnsupported, program, "the program ended with exit code ", WEXITSTATUS(status),
              "; its messages are above");
}

/// Reconstructs a light field with a program of the user, which is called as `COMMAND... EVENTS.npz LIGHT_FIELD.npy`:
/// it reads the event images of all cycles, with their patterns and the camera, and writes the light field, float32
/// [view_y, view_x, y, x]. What it prints goes to stderr. Fails with kNotFound (it cannot be started), kUnsupported (it
/// ends with an error), kCancelled (a stop was requested, which ends the program), and as write_event_images() and
/// read_light_field() do.
Result<lightfield::LightField> run_external(const std::vector<std::string>& command,
                                            const capture::EventImageFile& events) {
  E2LF_ASSIGN_OR_RETURN(const Workspace folder,
                        Workspace::create(fs::temp_directory_path() / cat("e2lf-external-", ::getpid())));
  const fs::path input = folder.path() / "events.npz", output = folder.path() / "light_field.npy";
  E2LF_RETURN_IF_ERROR(capture::write_event_images(input, events));
  std::vector<std::string> words = command;
  words.insert(words.end(), {input.string(), output.string()});
  E2LF_ASSIGN_OR_RETURN(const pid_t child, start(std::move(words)));
  E2LF_RETURN_IF_ERROR(wait_for(child, command.front()));
  if (!is_present(output)) {
    return fail(ErrorCode::kNotFound, command.front(),
                "the program wrote no light field; write it to the last argument as .npy, float32 [8, 8, y, x]");
  }
  lightfield::ReadOptions options;
  options.range = lightfield::RangePolicy::kKeep;
  return lightfield::read_light_field(output, options);
}

}  // namespace

Result<lightfield::Image> scene_disparity(const ComparedScene& scene, const LightField& truth) {
  const lightfield::Shape& shape = truth.shape();
  if (!depth::has_comparable_disparity(shape)) return lightfield::Image();
  if (scene.rendered_seed) {
    return lightfield::render_disparity(lightfield::demo_scene(*scene.rendered_seed),
                                        {shape.height, shape.width, 0.5F, 0.5F});
  }
  // A map of other views than the middle one of the scene, or for their spacing, is not the truth of this light field.
  const bool has_other_views = scene.group.step != 1 || scene.group.reverse_rows;
  const auto file = has_other_views ? std::nullopt : depth::find_true_disparity(scene.path);
  if (!file) {
    E2LF_ASSIGN_OR_RETURN(depth::DisparityMap map, depth::estimate_disparity(truth));
    return std::move(map.disparity);
  }
  E2LF_ASSIGN_OR_RETURN(lightfield::Image whole, depth::read_disparity(*file));
  const bool is_cropped = scene.group.width > 0 || scene.group.height > 0;
  if (whole.width < shape.width || whole.height < shape.height ||
      (!is_cropped && (whole.width != shape.width || whole.height != shape.height))) {
    return fail(ErrorCode::kShape, file->string(), "has ", whole.width, "x", whole.height, " px, the views have ",
                shape.width, "x", shape.height, "; give the map of this light field");
  }
  const LightField map({1, 1, whole.height, whole.width, 1}, whole.pixels);
  E2LF_ASSIGN_OR_RETURN(const LightField cropped,
                        lightfield::crop(map, {(whole.height - shape.height) / 2, (whole.width - shape.width) / 2,
                                               shape.height, shape.width}));
  return lightfield::view_image(cropped, 0, 0);
}

Result<LightField> load_scene(const ComparedScene& scene) {
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

Result<const pipeline::OpenedMethod*> JobRunner::method_of(const Job& job) {
  const auto key = std::pair(job.method, job.sensor);
  if (const auto known = methods_.find(key); known != methods_.end()) return &known->second;
  const ComparedMethod& method = plan_.methods[job.method];
  const capture::SensorProfile& camera = plan_.sensors[job.sensor].camera;
  const bool is_inversion = method.config.algorithm == "inversion";
  pipeline::MethodChoice choice{
      .algorithm = is_inversion ? pipeline::Algorithm::kInversion : pipeline::Algorithm::kNetwork,
      .codes = method.codes,
      .camera = method.network_camera,
      .constants = camera.constants,
      .events = {.camera = camera},
      .measurement = method.measurement,
      .precision = method.config.precision,
      .device = plan_.device};
  if (!is_inversion) {
    E2LF_ASSIGN_OR_RETURN(choice.model, pipeline::read_network(method.model));
  }
  E2LF_ASSIGN_OR_RETURN(pipeline::OpenedMethod opened, pipeline::open_method(std::move(choice)));
  const bool is_first =
      std::ranges::none_of(methods_, [&](const auto& known) { return known.first.first == job.method; });
  const auto foreign = std::ranges::find(opened.findings, "patterns-foreign", &diagnose::Finding::code);
  if (is_first && foreign != opened.findings.end()) diagnose::log_findings(method.config.name, {*foreign});
  return &methods_.emplace(key, std::move(opened)).first->second;
}

Result<const JobRunner::Cycles*> JobRunner::cycles_of(const Job& job, const LightField& truth) {
  const auto place = std::pair(job.scene, job.sensor);
  if (place != place_) simulated_.clear();
  place_ = place;
  const ComparedMethod& method = plan_.methods[job.method];
  for (const Simulated& known : simulated_) {
    if (known.codes == method.codes && known.kind == method.measurement && known.seed == job.seed) return &known.cycles;
  }
  const Sensor& sensor = plan_.sensors[job.sensor];
  const pipeline::SimulatedCamera camera{.measurement = method.measurement,
                                         .codes = method.codes,
                                         .profile = sensor.camera,
                                         .gain = sensor.config.gain,
                                         .residue = sensor.config.residue,
                                         .seed = job.seed};
  Simulated simulated{method.codes, method.measurement, job.seed, {}};
  for (size_t cycle = 0; cycle < sensor.config.cycles; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(capture::Measurement measured, pipeline::simulate_cycle(camera, truth, cycle));
    simulated.cycles.push_back(std::move(measured));
  }
  ++num_simulated_;
  return &simulated_.emplace_back(std::move(simulated)).cycles;
}

/// Returns the reconstruction with its cost, without the figures that depend on its gain.
Result<Outcome> JobRunner::run_method(const Job& job, const LightField& truth, const ProgressFn& progress) {
  const ComparedMethod& method = plan_.methods[job.method];
  E2LF_ASSIGN_OR_RETURN(const Cycles* cycles, cycles_of(job, truth));
  E2LF_ASSIGN_OR_RETURN(const pipeline::OpenedMethod* opened, method_of(job));
  const bool is_summed = opened->takes_sums();
  E2LF_ASSIGN_OR_RETURN(const recon::Method run, opened->ready({.passes = opened->network ? method.config.passes : 1,
                                                                .cycles = is_summed ? cycles->size() : 1}));
  Outcome outcome;
  const auto begin = std::chrono::steady_clock::now();
  if (is_summed) {
    const Sum sum = sum_of(*cycles);
    outcome.figures["saturated_events"] = sum.saturated;
    E2LF_ASSIGN_OR_RETURN(outcome.light_field, run(sum.measured, progress));
  } else {
    E2LF_ASSIGN_OR_RETURN(outcome.light_field, reconstruct_each(run, *cycles, progress));
  }
  outcome.figures["reconstruct_s"] = seconds_since(begin);
  add_costs(method, *cycles, outcome.figures);
  // Lenses at the edge extend beyond the scene.
  const lightfield::Shape &shape = truth.shape(), &found = outcome.light_field.shape();
  if (found.height != shape.height || found.width != shape.width) {
    E2LF_ASSIGN_OR_RETURN(outcome.light_field,
                          lightfield::crop(outcome.light_field, {0, 0, shape.height, shape.width}));
  }
  return outcome;
}

/// Reconstructs all cycles with the program of the method.
Result<Outcome> JobRunner::run_program(const Job& job, const LightField& truth) {
  const ComparedMethod& method = plan_.methods[job.method];
  E2LF_ASSIGN_OR_RETURN(const Cycles* cycles, cycles_of(job, truth));
  capture::EventImageFile events{.cycles = {},
                                 .setup = {.codes = method.codes, .camera = plan_.sensors[job.sensor].camera}};
  for (const capture::Measurement& cycle : *cycles) events.cycles.push_back(cycle.events);
  Outcome outcome;
  const auto begin = std::chrono::steady_clock::now();
  E2LF_ASSIGN_OR_RETURN(outcome.light_field, run_external(method.config.command, events));
  outcome.figures["reconstruct_s"] = seconds_since(begin);
  add_costs(method, *cycles, outcome.figures);
  return outcome;
}

Result<Outcome> JobRunner::run_scan(const Job& job, const LightField& truth, const ProgressFn& progress) {
  const Sensor& sensor = plan_.sensors[job.sensor];
  if (sensor.camera.is_pixel() || sensor.config.cycles > 1) {
    return fail(ErrorCode::kUnsupported, "",
                "a scan of views is simulated once, with pixels of v2e; remove this method for sensors "
                "with physical pixels or several cycles");
  }
  if (!scans_.contains(job.method)) {
    E2LF_ASSIGN_OR_RETURN(scans_[job.method], video::read_video_model(plan_.methods[job.method].model));
  }
  const ScanOptions options{.tau = sensor.camera.constants.tau, .gain = sensor.config.gain, .seed = job.seed};
  E2LF_ASSIGN_OR_RETURN(ScanResult scan, scan_to_light_field(scans_[job.method], truth, options, progress));
  Outcome outcome;
  outcome.light_field = std::move(scan.light_field);
  outcome.figures = {{"reconstruct_s", scan.reconstruct_s},
                     {"events_per_pixel", scan.events_per_pixel},
                     {"bits_per_pixel", eval::event_cost(scan.events_per_pixel).bits_per_light_field_pixel},
                     {"measurement_ms", scan.measurement_ms},
                     {"cycle_ms", scan.measurement_ms}};
  return outcome;
}

Result<Outcome> JobRunner::run(const Job& job, const LightField& truth, const lightfield::Image& disparity,
                               const ProgressFn& progress) {
  const ComparedMethod& method = plan_.methods[job.method];
  const Sensor& sensor = plan_.sensors[job.sensor];
  auto found = is_scan(method)       ? run_scan(job, truth, progress)
               : is_external(method) ? run_program(job, truth)
                                     : run_method(job, truth, progress);
  if (!found) {
    Error error = found.error();
    error.location = cat(method.config.name, " on ", plan_.scenes[job.scene].name, ", sensor ", sensor.config.name,
                         error.location.empty() ? "" : ": ", error.location);
    return error;
  }
  Outcome outcome = *std::move(found);
  LightField& field = outcome.light_field;
  // The frames have no absolute scale.
  const bool is_fitted = method.config.fit_gain || sensor.config.fit_gain || is_scan(method);
  const float gain = is_fitted ? eval::best_gain(truth, field) : method.config.gain / sensor.config.gain;
  for (float& value : field.data()) value *= gain;
  E2LF_ASSIGN_OR_RETURN(const eval::LightFieldMetrics quality, eval::compare(truth, field));
  add_quality(quality, outcome.figures);
  E2LF_RETURN_IF_ERROR(add_disparity(disparity, outcome));
  outcome.figures["gain"] = json_number(gain);
  outcome.figures["num_patterns"] = method.codes.num_patterns;
  return outcome;
}

}  // namespace e2lf::compare
