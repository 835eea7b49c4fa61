// SPDX-License-Identifier: MIT
// The verbs of live cameras: camera list, camera check, and record, which writes a live input byte for byte.
#include "e2lf/recordings/live/camera.h"

#include <cstdio>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/info/describe.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

Result<void> list_cameras(const CommonOptions& common) {
  Json cameras = Json::array();
  bool has_hal = false;
  std::optional<Error> failure;
  for (const recordings::CameraPlugin& plugin : recordings::camera_plugins()) {
    has_hal = has_hal || plugin.name == "metavision";
    if (!plugin.list) continue;
    const auto addresses = plugin.list();
    if (!addresses) {
      if (failure) log_warning(failure->text());
      failure = addresses.error();
      continue;
    }
    for (const std::string& address : *addresses) cameras.push_back(cat("camera://", plugin.name, "/", address));
  }
  if (failure && cameras.empty()) return *failure;
  if (failure) log_warning(failure->text());
  if (cameras.empty() && !has_hal && !common.json) {
    return fail(ErrorCode::kMissingDependency, "",
                "no camera was found, and this build does not support USB cameras; build it with the vendor's open "
                "HAL (docs/camera.md), or give a plugin in E2LF_CAMERA_PLUGINS");
  }
  if (common.json) {
    std::printf("%s", json_text({{"cameras", cameras}}).c_str());
  } else {
    for (const Json& camera : cameras) std::printf("%s\n", printable(camera.get<std::string>()).c_str());
  }
  return cameras.empty() && !common.json ? cameras::unopened_error("", {}) : Result<void>();
}

/// Statistics of the events and triggers that a camera sent.
struct CameraCheck {
  diagnose::TriggerInputs inputs;
  uint64_t events = 0, triggers = 0;
  std::optional<int64_t> last_us;
  int64_t longest_pause_us = 0;

  void add(const recordings::EventBatch& batch) {
    diagnose::add(batch.triggers, inputs);
    events += batch.events.size();
    for (const int64_t t_us : batch.events.t) {
      if (last_us) longest_pause_us = std::max(longest_pause_us, t_us - *last_us);
      last_us = t_us;
    }
    triggers += batch.triggers.size();
  }

  [[nodiscard]] Json json(const recordings::RecordingReader& reader, double seconds) const {
    const recordings::DecodeSummary summary = reader.summary();
    Json channels = diagnose::to_json(inputs);
    for (Json& channel : channels) {
      channel["rising_per_s"] = channel["rising"].get<double>() / seconds;
      channel["falling_per_s"] = channel["falling"].get<double>() / seconds;
    }
    return {{"seconds", seconds},
            {"events_per_s", static_cast<double>(summary.events()) / seconds},
            {"on_share", events == 0 ? 0.0 : static_cast<double>(summary.events_on) / static_cast<double>(events)},
            {"longest_pause_us", longest_pause_us},
            {"gaps", summary.num_gaps},
            {"trigger_channels", channels},
            {"sensor", sensor_json(summary)},
            {"live", live_json(summary)},
            {"left_out", losses_json(summary)},
            {"header", header_json(reader.info())}};
  }

  [[nodiscard]] std::string text(const Json& json, const recordings::DecodeSummary& summary) const {
    std::string text =
        formatted("events:    %.3f M/s, %.1f %% ON, longest pause %lld us\n", json["events_per_s"].get<double>() * 1e-6,
                  json["on_share"].get<double>() * 100, static_cast<long long>(longest_pause_us));
    text += cat("triggers:  ", triggers, "\n");
    for (const Json& channel : json["trigger_channels"]) {
      text += cat("           channel ", channel["channel"].get<int>(), ": ", channel["rising_per_s"].get<double>(),
                  " rising and ", channel["falling_per_s"].get<double>(), " falling edges per second\n");
    }
    text += cat("gaps:      ", summary.num_gaps, "\n");
    const std::string sensor = recordings::sensor_text(summary);
    if (!sensor.empty()) text += cat("sensor:    ", sensor, "\n");
    for (const auto& [key, value] : json["header"].items()) {
      text += cat("header:    ", key, " = ", value.get<std::string>(), "\n");
    }
    return text;
  }
};

struct CheckArguments {
  fs::path input = "camera://metavision";
  double seconds = 5;
  RecordingFlags recording;
};

Result<void> check_camera(const CheckArguments& arguments, const Verb& verb) {
  constexpr double kPatienceS = 2;
  E2LF_ASSIGN_OR_RETURN(recordings::OpenOptions options, open_options(arguments.input, arguments.recording));
  options.counts_reports = true;
  E2LF_ASSIGN_OR_RETURN(auto source, recordings::open_live_bytes(arguments.input.string(), options.camera));
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> length(arguments.seconds);
  source->end_at(begin + std::chrono::duration_cast<std::chrono::nanoseconds>(length));
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_recording(
                                               std::unique_ptr<recordings::ByteSource>(std::move(source)), options));
  CameraCheck check;
  recordings::EventBatch batch;
  bool has_warned = false;
  for (bool more = true; more;) {
    E2LF_ASSIGN_OR_RETURN(more, reader->read(batch));
    check.add(batch);
    if (check.triggers == 0 && !has_warned && more && seconds_since(begin) > kPatienceS) {
      diagnose::log_findings(arguments.input.string(), {diagnose::no_trigger_finding(kPatienceS)});
      has_warned = true;
    }
  }
  const double seconds = std::max(seconds_since(begin), 1e-3);
  const recordings::DecodeSummary summary = reader->summary();
  diagnose::Findings findings = diagnose::check_camera(*reader, check.events, check.triggers, arguments.seconds);
  Json json = check.json(*reader, seconds);
  json["findings"] = diagnose::to_json(findings);
  std::printf("%s", verb.common().json ? json_text(json).c_str() : printable(check.text(json, summary)).c_str());
  warn_of_losses(arguments.input, summary);
  verb.set_failed_input(summary.live.failure);
  if (findings.empty()) return {};
  const diagnose::Finding first = findings.front();
  findings.erase(findings.begin());
  diagnose::log_findings(arguments.input.string(), findings);
  return fail(ErrorCode::kInvalidValue, arguments.input, diagnose::text_of(first));
}

int run_camera_list(const std::vector<std::string>& arguments) {
  Verb verb("camera list", "List the cameras that are connected.", "e2lf camera list");
  return verb.run(arguments, [&] { return list_cameras(verb.common()); });
}

int run_camera_check(const std::vector<std::string>& arguments) {
  Verb verb("camera check",
            "Observe a camera for some seconds and report problems with its triggers and events, and losses.",
            "e2lf camera check camera://metavision --seconds 5");
  CheckArguments check;
  verb.app()
      .add_option("input,-i,--input", check.input, "camera://NAME, tcp://127.0.0.1:PORT, replay:FILE or a named pipe")
      ->capture_default_str();
  verb.app()
      .add_option("--seconds", check.seconds, "duration of the observation")
      ->check(positive_number())
      ->capture_default_str();
  add_recording_options(verb.app(), check.recording);
  verb.stop_gently();
  return verb.run(arguments, [&] { return check_camera(check, verb); });
}

}  // namespace

int run_camera(const std::vector<std::string>& arguments) {
  return run_subverb("camera",
                     {{"list", "list the cameras that are connected", run_camera_list},
                      {"check", "observe a camera and report problems", run_camera_check}},
                     arguments);
}

namespace {

struct RecordArguments {
  fs::path input, output;
  double seconds = 0;  ///< 0 = until the input ends
  recordings::CameraSetup camera;
};

/// Returns the path of the camera's settings: x.bias beside x.raw. Fails if this file exists and does not belong to an
/// earlier recording of the same name.
Result<fs::path> bias_place(const RecordArguments& arguments, const Verb& verb) {
  fs::path place = arguments.output;
  place.replace_extension(".bias");
  E2LF_RETURN_IF_ERROR(check_apart(place, verb.named_inputs()));
  if (!is_there(place)) return place;
  const auto earlier = read_json(record_path_beside(arguments.output));
  const bool is_ours = earlier && earlier->contains("notes") && (*earlier)["notes"].is_object() &&
                       (*earlier)["notes"].value("biases", "") == place.filename().string();
  if (verb.common().overwrite && is_ours) return place;
  return fail(ErrorCode::kExists, place,
              "the camera's settings would replace this file; move it away or choose another output");
}

struct Copied {
  uint64_t bytes = 0;
  Result<void> written = {};
};

/// Copies bytes until the source ends or a write fails. Fails if the source does.
Result<Copied> copy_bytes(recordings::LiveSource& source, recordings::ByteSink& sink, const ProgressFn& progress) {
  Copied copied;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> bytes, source.fetch(1));
    if (bytes.empty()) {
      if (source.pass_break()) continue;
      return copied;
    }
    copied.written = sink.write(bytes);
    if (!copied.written) return copied;
    copied.bytes += bytes.size();
    source.consume(bytes.size());
    if (progress) progress(copied.bytes, 0);
  }
}

/// Returns the counts of the sensor itself, if the file is short enough to be read again immediately.
recordings::DecodeSummary sensor_counts(const fs::path& file) {
  constexpr uintmax_t kMostBytes = uintmax_t{1} << 31;
  std::error_code error;
  if (const uintmax_t size = fs::file_size(file, error); error || size > kMostBytes) return {};
  const auto reader =
      recordings::open_recording(file, {.policy = recordings::DecodePolicy::kSkip, .counts_reports = true});
  if (!reader) return {};
  (*reader)->skip_events(INT64_MIN, INT64_MAX);
  recordings::EventBatch batch;
  for (Result<bool> more = true; more && *more;) more = (*reader)->read(batch);
  return (*reader)->summary();
}

const char* end_name(const recordings::DecodeSummary& summary, bool has_time_passed) {
  if (!summary.live.failure.empty()) return "failure";
  if (stop_requested()) return "signal";
  return has_time_passed ? "seconds" : "input";
}

/// Commits the recording with its record and the camera's settings, whatever ended it.
Result<void> keep(const RecordArguments& arguments, const recordings::LiveSource& source, const Copied& copied,
                  OutputFile& output, RunRecord& record, const Verb& verb) {
  const recordings::DecodeSummary summary = source.left_out();
  record.note("bytes", copied.bytes);
  record.note("live", live_json(summary));
  const std::string biases = source.bias_file_text();
  fs::path bias_file;
  if (!biases.empty() && !output.is_stream()) {
    E2LF_ASSIGN_OR_RETURN(bias_file, bias_place(arguments, verb));
    record.note("biases", bias_file.filename().string());
  }
  if (!output.is_stream()) {
    // Bytes that are not a recording are kept nevertheless, because they cannot be received again.
    const auto reader = recordings::open_recording(output.path());
    if (reader) record.note("header", header_json((*reader)->info()));
    if (recordings::is_camera_name(arguments.input.string())) {
      const recordings::DecodeSummary counts = sensor_counts(output.path());
      record.note("sensor", sensor_json(counts));
      if (const std::string text = recordings::sensor_text(counts); !text.empty()) {
        log_info(cat(arguments.input.string(), ": the sensor ", text));
      }
    }
    if (!reader) log_warning(cat(arguments.output.string(), ": ", reader.error().message));
    record.end_step("record");
    const auto written = record.write(output.record_path());
    if (!written) log_warning(cat("the record of the run was not written: ", written.error().text()));
    E2LF_RETURN_IF_ERROR(output.commit());
    if (!bias_file.empty()) E2LF_RETURN_IF_ERROR(write_file(bias_file, biases));
  }
  warn_of_losses(arguments.input, summary);
  if (summary.live.num_gaps > 0) {
    log_warning(cat(arguments.output.string(), ": data are missing at ", summary.live.num_gaps,
                    summary.live.num_gaps == 1 ? " place" : " places",
                    output.is_stream() ? "" : "; its record lists them"));
  }
  verb.set_failed_input(summary.live.failure);
  print_result(verb.common(),
               {{"file", arguments.output.string()},
                {"bytes", copied.bytes},
                {"biases", bias_file.string()},
                {"live", live_json(summary)}},
               cat(copied.bytes, " bytes in ", arguments.output.string(),
                   bias_file.empty() ? "" : cat(", and the biases in ", bias_file.string()), "\n"),
               output.text());
  return copied.written;
}

Result<void> record_input(const RecordArguments& arguments, const Verb& verb) {
  OutputRules rules = output_rules(verb);
  rules.streams = true;
  E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(arguments.output, rules));
  // This is checked before the camera starts, because its data must not wait for it.
  if (!output.is_stream() && recordings::is_camera_name(arguments.input.string())) {
    E2LF_RETURN_IF_ERROR(bias_place(arguments, verb));
  }
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(const auto sink, recordings::open_file_sink(output.path()));
  E2LF_ASSIGN_OR_RETURN(const auto source, recordings::open_live_bytes(arguments.input.string(), arguments.camera));
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> length(arguments.seconds);
  if (arguments.seconds > 0) source->end_at(begin + std::chrono::duration_cast<std::chrono::nanoseconds>(length));
  ProgressBar bar("record", verb.common().quiet, "bytes");
  E2LF_ASSIGN_OR_RETURN(Copied copied, copy_bytes(*source, *sink, bar.callback()));
  hide_progress();
  if (copied.bytes == 0 && copied.written) {
    return fail(ErrorCode::kTruncated, arguments.input, "the source sent nothing; check the sender");
  }
  const bool has_time_passed = arguments.seconds > 0 && std::chrono::steady_clock::now() - begin >= length;
  record.note("ended_by", end_name(source->left_out(), has_time_passed));
  E2LF_RETURN_IF_ERROR(sink->commit());
  // A write that failed may have written a part.
  std::error_code error;
  if (!copied.written && !output.is_stream()) copied.bytes = fs::file_size(output.path(), error);
  if (error || copied.bytes == 0) return copied.written;
  return keep(arguments, *source, copied, output, record, verb);
}

}  // namespace

int run_record(const std::vector<std::string>& arguments) {
  Verb verb("record", "Record a live input byte for byte, with the settings of the camera beside it.",
            "e2lf record camera://metavision -o recording.raw --seconds 10");
  RecordArguments recording;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", recording.input,
                 "camera://NAME, tcp://127.0.0.1:PORT, replay:FILE, a named pipe, or - for standard input")
      ->required();
  app.add_option("output,-o,--output", recording.output, "file to write")->required();
  app.add_option("--seconds", recording.seconds, "how long to record, 0 = until the input ends or Ctrl-C")
      ->capture_default_str();
  add_camera_options(app, recording.camera);
  verb.stop_gently();
  return verb.run(arguments, [&] { return record_input(recording, verb); });
}

}  // namespace e2lf::cli
