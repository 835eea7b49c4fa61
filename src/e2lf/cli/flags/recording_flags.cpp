// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/recording_flags.h"

#include <cstdio>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_values.h"
#include "e2lf/recordings/open/open_named_recording.h"

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
                                .switches_filters_off = flags.switches_filters_off};
  for (const std::string& text : flags.regions) {
    recordings::SensorRegion region;
    int length = 0;
    const int found =
        std::sscanf(text.c_str(), "%5d,%5d,%5d,%5d%n", &region.x, &region.y, &region.width, &region.height, &length);
    if (found != 4 || static_cast<size_t>(length) != text.size()) {
      return Error{ErrorCode::kInvalidValue, cat("\"", text, "\" is not a region; give X,Y,WIDTH,HEIGHT"), "--roi"};
    }
    setup.regions.push_back(region);
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
      ->group(group);
  add("--polarities", flags.polarities, "numbers of OFF and ON in a table of events, e.g. 1,2; default: 0,1 or -1,1");
  app.add_option("--restart", flags.restart,
                 "if the clock starts again (a restarted camera, joined files): continue shifts the later part behind "
                 "the earlier one, split keeps the parts separate (info, convert), refuse fails")
      ->check(CLI::IsMember(words_of(kRestartPolicies)))
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
    return Error{ErrorCode::kInvalidValue,
                 cat("the range from ", flags.from_us, " to ", flags.to_us, " us is empty; give a later --to-us"),
                 "--from-us"};
  }
  recordings::OpenOptions open;
  open.restart = choice_of(flags.restart, kRestartPolicies);
  if (open.restart == recordings::RestartPolicy::kSplit && !reads_parts) {
    return Error{ErrorCode::kInvalidValue,
                 "split is only for `e2lf info`, which lists the parts, and `e2lf convert`, which writes each to a "
                 "separate file; convert the recording first, or use continue",
                 "--restart"};
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
  open.threads = 0;
  E2LF_ASSIGN_OR_RETURN(open.camera, camera_setup(flags.camera));
  // With a camera, damage is reported at once; for a file, the summary at the end is sufficient.
  open.policy = flags.is_strict  ? recordings::DecodePolicy::kStrict
                : is_live(input) ? recordings::DecodePolicy::kReport
                                 : recordings::DecodePolicy::kSkip;
  return open;
}

void say_assumptions(const recordings::RecordingReader& reader) {
  for (const recordings::Assumption& assumption : reader.info().assumptions) {
    log_info(cat(reader.name(), ": ", assumption_text(assumption)));
  }
}

std::string assumption_text(const recordings::Assumption& assumption) {
  if (assumption.setting == Setting::kStream) return assumption.text + "; use --stream to select another";
  return assumption.text;
}

Json reading_json(const recordings::RecordingInfo& info) {
  if (!info.table) return nullptr;
  return {{"columns", info.table->columns}, {"time_unit", info.table->time_unit}, {"polarity", info.table->polarity}};
}

Json header_json(const recordings::RecordingInfo& info) {
  Json header = Json::object();
  for (const auto& [key, value] : info.header) header[key] = value;
  return header;
}

Json reading_notes(const fs::path& input, const recordings::RecordingInfo& info) {
  Json notes = {{"read_as", reading_json(info)}};
  if (is_live(input)) notes["header"] = header_json(info);
  return notes;
}

Json sensor_json(const recordings::DecodeSummary& summary) {
  if (recordings::sensor_text(summary).empty()) return nullptr;
  return {{"events_in", summary.sensor_events_in}, {"events_sent", summary.sensor_events_sent}};
}

Json losses_json(const recordings::DecodeSummary& summary) {
  Json json = Json::array();
  for (const recordings::Loss& loss : recordings::losses(summary)) {
    json.push_back({{"reason", loss.reason}, {"count", loss.count}, {"first_byte", loss.first_byte}});
  }
  return json;
}

Json live_json(const recordings::DecodeSummary& summary) {
  const recordings::LiveBacklog& live = summary.live;
  if (live == recordings::LiveBacklog()) return nullptr;
  Json gaps = Json::array();
  for (const recordings::LiveGap& gap : live.gaps) {
    gaps.push_back({{"byte", gap.byte}, {"dropped_bytes", gap.dropped_bytes}, {"lost_buffers", gap.lost_buffers}});
  }
  return {{"most_behind_s", static_cast<double>(live.most_behind_us) * 1e-6},
          {"pauses", live.pauses},
          {"may_have_lost_events", live.loses_events},
          {"dropped_bytes", live.dropped_bytes},
          {"lost_buffers", live.lost_buffers},
          {"num_gaps", live.num_gaps},
          {"gaps", gaps},
          {"failure", live.failure}};
}

void warn_of_losses(const fs::path& input, const recordings::DecodeSummary& summary) {
  if (const std::string live = recordings::live_text(summary); !live.empty()) {
    (summary.live.num_gaps > 0 ? log_warning : log_info)(cat(input.string(), ": ", live));
  }
  if (const std::string restarts = recordings::restart_text(summary); !restarts.empty()) {
    const bool is_moved = summary.restarts.front().shift_us != 0;
    log_warning(cat(input.string(), ": ", restarts,
                    is_moved ? " (--restart continue; split keeps the parts separate, refuse fails there)" : ""));
  }
  const std::vector<recordings::Loss> losses = recordings::losses(summary);
  if (losses.empty()) return;
  const bool is_outside = summary.of(recordings::Violation::kOutOfRange).count > 0;
  const char* const advice = is_outside ? "; give the sensor size with --sensor-width and --sensor-height" : "";
  log_warning(cat(input.string(), ": left out ", recordings::loss_text(losses), advice));
}

Json restarts_json(const recordings::DecodeSummary& summary) {
  Json json = Json::array();
  for (const recordings::Restart& restart : summary.restarts) {
    json.push_back({{"byte", restart.byte},
                    {"before_us", restart.before_us},
                    {"after_us", restart.after_us},
                    {"shift_us", restart.shift_us}});
  }
  return json;
}

std::string sorted_text(const recordings::DecodeSummary& summary) {
  return summary.out_of_order == 0 ? "" : cat(", ", summary.out_of_order, " of them sorted to their place");
}

}  // namespace e2lf::cli
