// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/stream_flags.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/program/options.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// The time after which the rim of the table has moved by a pixel of the views, which linear interpolation between
/// light fields permits.
int64_t turntable_field_us(double rpm, size_t width) {
  constexpr double kRimPx = 0.84, kMostPx = 1;  // a corner in front moves by kRimPx of the width per rad
  constexpr double kLeastUs = 1'000, kMostUs = 100'000;
  const double px_per_s = std::abs(rpm) / 60 * 2 * std::numbers::pi * kRimPx * static_cast<double>(width);
  return static_cast<int64_t>(std::clamp(1e6 * kMostPx / px_per_s, kLeastUs, kMostUs));
}

/// Returns a scene that shows one light field after another; the last one remains.
Result<StreamScene> sequence(const fs::path& input, int64_t field_us, const SceneOptions& options, bool is_quiet) {
  std::vector<fs::path> fields;
  size_t others = 0;
  for (const fs::path& path : paths_in(input)) {
    if (lightfield::detect_kind(path)) {
      fields.push_back(path);
    } else {
      ++others;
    }
  }
  std::ranges::sort(fields, is_before_in_number_order);
  if (others > 0 && !is_quiet) {
    log_info(cat(input.string(), ": left out ", counted(others, "file"), " without a light field"));
  }
  if (fields.empty()) {
    return fail(ErrorCode::kNotFound, input,
                "this is not a folder of light fields, which --field-us requires; give one");
  }
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField first, load_scene(fields.front(), options, is_quiet));
  StreamScene result{{}, first.shape().height, first.shape().width};
  result.scene.knot_us = field_us;
  result.scene.at = [fields, options](uint64_t knot) {
    return load_scene(fields[std::min<size_t>(knot, fields.size() - 1)], options, true);
  };
  return result;
}

StreamScene turntable(const StreamFlags& flags, const SceneOptions& options, uint64_t seed) {
  StreamScene result{{}, flags.height, flags.width};
  result.scene.knot_us = flags.field_us > 0 ? flags.field_us : turntable_field_us(flags.turntable_rpm, flags.width);
  const double turn =
      flags.turntable_rpm / 60 * 2 * std::numbers::pi * static_cast<double>(result.scene.knot_us) * 1e-6;
  const lightfield::Shape shape{options.views_y, options.views_x, flags.height, flags.width, 1};
  constexpr size_t kSamples = 2;  // per pixel; the noise of the camera exceeds the rest
  result.scene.at = [=](uint64_t knot) -> Result<lightfield::LightField> {
    const auto angle = static_cast<float>(std::remainder(turn * static_cast<double>(knot), 2 * std::numbers::pi));
    lightfield::LightField field =
        lightfield::render_light_field(lightfield::turntable_scene(angle, seed), shape, kSamples);
    lightfield::orient(field, options.flags.orientation.value());
    return field;
  };
  return result;
}

}  // namespace

void add_stream_options(CLI::App& app, StreamFlags& flags) {
  const OptionGroup group(app, kStreamOptions);
  const auto number = [&](const char* name, auto& value, const char* help) {
    app.add_option(name, value, help)->check(CLI::NonNegativeNumber)->capture_default_str();
  };
  app.add_flag("--stream", flags.stream,
               "simulate event by event, with references that are carried from cycle to cycle; implied by recordings "
               "of physical pixels, by esim and v2e, and by the flags below");
  app.add_option("--schedule", flags.schedule, "schedule of the patterns (JSON); default: the paper's eight patterns")
      ->check(CLI::ExistingFile);
  number("--rise-us", flags.rise_us, "rise time of the display from one pattern to the next");
  app.add_option("--field-us", flags.field_us, "the input is a folder of light fields at this interval, us")
      ->check(CLI::Range(int64_t{0}, int64_t{3'600'000'000}))
      ->capture_default_str();
  app.add_option("--turntable", flags.turntable_rpm,
                 "simulate a still life on a turntable instead of an input; revolutions per minute (1.75 in the paper)")
      ->check(CLI::Range(-1000.0, 1000.0));
  add_count(app, "--width", flags.width, 16, 8192, "size of the turntable's views, px");
  add_count(app, "--height", flags.height, 16, 8192, "size of the turntable's views, px");
  add_choice(app, "--v2e-preset", flags.v2e_preset, {"default", "noisy", "clean"},
             "parameters of v2e: default, noisy or clean");
  number("--refractory-us", flags.refractory_us, "physical pixels, esim: refractory period after an event");
  number("--leak-rate-hz", flags.leak_rate_hz, "physical pixels: rate of ON events of each pixel in constant light");
  number("--shot-rate-hz", flags.shot_rate_hz, "physical pixels: rate of random events of each pixel in the dark");
  number("--hot-pixels", flags.hot_share, "physical pixels: fraction of hot pixels, 0 to 1");
  number("--readout-limit", flags.readout_limit,
         "largest number of events that the sensor reads out per second, 1.066e9 for an EVK4; further events wait or "
         "are lost; 0 = no limit");
}

bool need_stream(const StreamFlags& flags) {
  return flags.stream || !flags.schedule.empty() || flags.rise_us > 0 || flags.field_us > 0 || flags.has_turntable() ||
         flags.refractory_us > 0 || flags.leak_rate_hz > 0 || flags.shot_rate_hz > 0 || flags.hot_share > 0 ||
         flags.readout_limit > 0;
}

Result<streams::StreamOptions> stream_options(const StreamFlags& flags, const std::string& event_model,
                                              const capture::SensorConstants& constants,
                                              const std::optional<capture::SensorProfile>& camera, uint64_t seed) {
  streams::StreamOptions options = streams::camera_stream(camera.value_or(capture::SensorProfile{}), seed);
  const bool is_pixel = options.model == streams::StreamModel::kPixel;
  if (!is_pixel) {
    E2LF_ASSIGN_OR_RETURN(options.model, streams::stream_model_from_name(event_model));
    options.constants = constants;
  }
  if (options.model == streams::StreamModel::kPixel && !is_pixel) {
    return fail(ErrorCode::kInvalidValue, "", "the event model pixel requires a camera; give --camera, e.g. evk4-lcos");
  }
  const bool is_esim = options.model == streams::StreamModel::kEsim;
  if ((flags.refractory_us > 0 && !is_pixel && !is_esim) ||
      (!is_pixel && (flags.leak_rate_hz > 0 || flags.shot_rate_hz > 0 || flags.hot_share > 0))) {
    return fail(ErrorCode::kInvalidValue, "", "the event model ", streams::stream_model_name(options.model),
                " does not use --refractory-us, ",
                "--leak-rate-hz, --shot-rate-hz or --hot-pixels; leave them out, or give --camera evk4-lcos");
  }
  options.esim_refractory_us = options.defects.refractory_us = flags.refractory_us;
  options.defects.leak_rate_hz = flags.leak_rate_hz;
  options.defects.shot_rate_hz = flags.shot_rate_hz;
  options.defects.hot_share = flags.hot_share;
  options.readout.events_per_s = flags.readout_limit;
  E2LF_ASSIGN_OR_RETURN(options.v2e, streams::v2e_preset(flags.v2e_preset));
  return options;
}

Result<StreamScene> open_stream_scene(const fs::path& input, const StreamFlags& flags, const SceneOptions& options,
                                      uint64_t seed, bool is_quiet) {
  if (flags.has_turntable()) return turntable(flags, options, seed);
  if (flags.field_us > 0) return sequence(input, flags.field_us, options, is_quiet);
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField field, load_scene(input, options, is_quiet));
  StreamScene still{{}, field.shape().height, field.shape().width};
  still.scene.at = [field = std::move(field)](uint64_t knot) mutable {
    E2LF_REQUIRE(knot == 0 && field.shape().height > 0, "a still scene has one light field");
    return Result(std::exchange(field, {}));
  };
  return still;
}

}  // namespace e2lf::cli
