// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/recording_flags.h"

#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/program/option_values.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

namespace {

constexpr Choice<recordings::TimeUnit> kTimeUnits[] = {{"auto", recordings::TimeUnit::kAuto},
                                                       {"s", recordings::TimeUnit::kSeconds},
                                                       {"ms", recordings::TimeUnit::kMilliseconds},
                                                       {"us", recordings::TimeUnit::kMicroseconds},
                                                       {"ns", recordings::TimeUnit::kNanoseconds}};
constexpr Choice<recordings::RestartPolicy> kRestartPolicies[] = {{"continue", recordings::RestartPolicy::kContinue},
                                                                  {"split", recordings::RestartPolicy::kSplit},
                                                                  {"refuse", recordings::RestartPolicy::kRefuse}};

}  // namespace

void add_camera_options(CLI::App& app, CameraFlags& flags) {
  constexpr char kGroup[] = "Live cameras";
  const auto repeatable = [&](const char* name, std::vector<std::string>& values, const char* text) {
    app.add_option(name, values, text)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false)
        ->group(kGroup);
  };
  repeatable("--trigger-channel", flags.trigger_channels,
             "trigger input to enable: main, aux, the number of its triggers, or none (repeatable); default: all");
  app.add_option("--biases", flags.biases, "file of sensor biases (.bias); default: those of the camera")
      ->group(kGroup);
  app.add_option("--max-event-rate", flags.max_events_per_s,
                 "events/s above which the sensor drops events, 0 = no limit; default: as set in the camera")
      ->group(kGroup);
  repeatable("--roi", flags.regions,
             "rectangle of the sensor whose pixels send events: X,Y,WIDTH,HEIGHT in px (repeatable)");
  app.add_option("--encoding", flags.encoding, "encoding of the camera's events; default: as set in the camera")
      ->check(CLI::IsMember({"evt2", "evt2.1", "evt3"}))
      ->group(kGroup);
  app.add_flag("--no-sensor-filters", flags.switches_filters_off,
               "switch off the anti-flicker and event trail filters of the sensor, which drop events of the patterns")
      ->group(kGroup);
}

Result<recordings::CameraSetup> camera_setup(const CameraFlags& flags) {
  recordings::CameraSetup setup{.trigger_channels = flags.trigger_channels,
                                .biases = flags.biases,
                                .max_events_per_s = flags.max_events_per_s,
                                .regions = {},
                                .encoding = flags.encoding,
                                .switches_filters_off = flags.switches_filters_off,
                                .running = flags.running};
  for (const std::string& text : flags.regions) {
    auto regions = recordings::parse_regions(text);
    if (!regions) return Error{regions.error().code, regions.error().message, "--roi"};
    setup.regions.insert(setup.regions.end(), regions->begin(), regions->end());
  }
  return setup;
}

void add_recording_options(CLI::App& app, RecordingFlags& flags, const std::string& group) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    app.add_option(name, value, text)->group(group);
  };
  add("--event-format", flags.format, "format of the recording, if it cannot be detected");
  add("--sensor-width", flags.width, "width of the sensor in px, if the recording does not state it");
  add("--sensor-height", flags.height, "height of the sensor in px, if the recording does not state it");
  add("--stream", flags.stream, "number or name of a stream of events, if the recording contains several");
  add("--columns", flags.columns, "order of the columns of a table of events, e.g. txyp; - skips a column");
  app.add_option("--time-unit", flags.time_unit,
                 "unit of the times in text, numpy and HDF5 tables: s, ms, us or ns; auto = as names state, otherwise "
                 "us for whole numbers and s for fractions")
      ->check(CLI::IsMember(words_of(kTimeUnits)))
      ->capture_default_str()
      ->group(group);
  add("--polarities", flags.polarities, "numbers of OFF and ON in a table of events, e.g. 1,2; default: 0,1 or -1,1");
  app.add_option("--restart", flags.restart,
                 "if the clock starts again (a restarted camera, joined files): continue shifts the later part behind "
                 "the earlier one, split keeps the parts separate (info, convert), refuse fails")
      ->check(CLI::IsMember(words_of(kRestartPolicies)))
      ->capture_default_str()
      ->group(group);
  add("--from-us", flags.from_us, "recordings: leave out data before this time on the clock of the recording");
  add("--to-us", flags.to_us, "recordings: leave out data at or after this time on the clock of the recording");
  app.add_flag("--relative", flags.is_relative,
               "recordings: --from-us and --to-us are relative to the first event or trigger")
      ->group(group);
  add_camera_options(app, flags.camera);
  app.add_flag("--strict", flags.is_strict,
               "fail and write nothing if events would be left out (damage, outside the sensor, count too large)");
}

bool is_live(const fs::path& input) {
  return recordings::is_live_recording(input.string());
}

Result<recordings::OpenOptions> open_options(const fs::path& input, const RecordingFlags& flags, bool reads_parts) {
  if (flags.from_us >= flags.to_us) {
    return fail(ErrorCode::kInvalidValue, "--from-us", "the range from ", flags.from_us, " to ", flags.to_us,
                " us is empty; give a later --to-us");
  }
  recordings::OpenOptions open;
  open.restart = choice_of(flags.restart, kRestartPolicies);
  if (open.restart == recordings::RestartPolicy::kSplit && !reads_parts) {
    return fail(ErrorCode::kInvalidValue, "--restart",
                "split is only for `e2lf info`, which lists the parts, and `e2lf convert`, which writes each to a "
                "separate file; convert the recording first, or use continue");
  }
  open.format = flags.format;
  open.width = flags.width;
  open.height = flags.height;
  open.columns = flags.columns;
  open.stream = flags.stream;
  open.polarities = flags.polarities;
  open.time_unit = choice_of(flags.time_unit, kTimeUnits);
  open.from_us = flags.from_us;
  open.to_us = flags.to_us;
  open.range = flags.is_relative ? recordings::TimeOrigin::kZero : recordings::TimeOrigin::kAbsolute;
  E2LF_ASSIGN_OR_RETURN(open.camera, camera_setup(flags.camera));
  // With a camera, damage is reported at once; for a file, the summary at the end is sufficient.
  open.policy = flags.is_strict  ? recordings::DecodePolicy::kStrict
                : is_live(input) ? recordings::DecodePolicy::kReport
                                 : recordings::DecodePolicy::kSkip;
  return open;
}

}  // namespace e2lf::cli
