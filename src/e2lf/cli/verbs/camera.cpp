// SPDX-License-Identifier: MIT
// e2lf camera: lists and checks live cameras
#include <cstdio>

#include "e2lf/base/format.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/cli/flags/recording_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/files/options.h"
#include "e2lf/info/describe.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/program/option_values.h"
#include "e2lf/recordings/open/open_named_recording.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

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
    return Error{ErrorCode::kMissingDependency,
                 "no camera was found, and this build does not support USB cameras; build it with the vendor's open "
                 "HAL (docs/camera.md), or give a plugin in E2LF_CAMERA_PLUGINS",
                 ""};
  }
  if (common.json) {
    std::printf("%s", json_text({{"cameras", cameras}}).c_str());
  } else {
    for (const Json& camera : cameras) std::printf("%s\n", printable(camera.get<std::string>()).c_str());
  }
  return cameras.empty() && !common.json ? recordings::unopened_error("", {}, recordings::find_usb_cameras())
                                         : Result<void>();
}

/// Statistics of the events and triggers that a camera sent.
class CameraCheck {
 public:
  void add(const recordings::EventBatch& batch) {
    statistics_.add(batch);
    events_ += batch.events.size();
    for (const int64_t t_us : batch.events.t) {
      if (last_us_) longest_pause_us_ = std::max(longest_pause_us_, t_us - *last_us_);
      last_us_ = t_us;
    }
    triggers_ += batch.triggers.size();
  }

  [[nodiscard]] uint64_t triggers() const { return triggers_; }

  [[nodiscard]] Json json(const recordings::RecordingReader& reader, double seconds) const {
    const recordings::DecodeSummary summary = reader.summary();
    Json channels = statistics_.triggers_json();
    for (Json& channel : channels) {
      channel["rising_per_s"] = channel["rising"].get<double>() / seconds;
      channel["falling_per_s"] = channel["falling"].get<double>() / seconds;
    }
    return {{"seconds", seconds},
            {"events_per_s", static_cast<double>(summary.events()) / seconds},
            {"on_share", events_ == 0 ? 0.0 : static_cast<double>(summary.events_on) / static_cast<double>(events_)},
            {"longest_pause_us", longest_pause_us_},
            {"gaps", summary.num_gaps},
            {"trigger_channels", channels},
            {"sensor", sensor_json(summary)},
            {"live", live_json(summary)},
            {"left_out", losses_json(summary)},
            {"header", header_json(reader.info())}};
  }

  [[nodiscard]] diagnose::Findings findings(const recordings::RecordingReader& reader, double seconds) const {
    return diagnose::check_camera(reader, events_, triggers_, seconds);
  }

  [[nodiscard]] std::string text(const Json& json, const recordings::DecodeSummary& summary) const {
    std::string text =
        formatted("events:    %.3f M/s, %.1f %% ON, longest pause %lld us\n", json["events_per_s"].get<double>() * 1e-6,
                  json["on_share"].get<double>() * 100, static_cast<long long>(longest_pause_us_));
    text += cat("triggers:  ", triggers_, "\n");
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

 private:
  RecordingStatistics statistics_;
  uint64_t events_ = 0, triggers_ = 0;
  std::optional<int64_t> last_us_;
  int64_t longest_pause_us_ = 0;
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
  const auto begin = Clock::now();
  const std::chrono::duration<double> length(arguments.seconds);
  source->end_at(begin + std::chrono::duration_cast<std::chrono::nanoseconds>(length));
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_recording(
                                               std::unique_ptr<recordings::ByteSource>(std::move(source)), options));
  const auto passed_s = [begin] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  CameraCheck check;
  recordings::EventBatch batch;
  bool is_told = false;
  for (bool more = true; more;) {
    E2LF_ASSIGN_OR_RETURN(more, reader->read(batch));
    check.add(batch);
    if (check.triggers() == 0 && !is_told && more && passed_s() > kPatienceS) {
      diagnose::log_findings(arguments.input.string(), {diagnose::no_trigger_finding(kPatienceS)}, "--");
      is_told = true;
    }
  }
  const double seconds = std::max(passed_s(), 1e-3);
  const recordings::DecodeSummary summary = reader->summary();
  diagnose::Findings findings = check.findings(*reader, arguments.seconds);
  Json json = check.json(*reader, seconds);
  json["findings"] = diagnose::to_json(findings);
  std::printf("%s", verb.common().json ? json_text(json).c_str() : printable(check.text(json, summary)).c_str());
  warn_of_losses(arguments.input, summary);
  verb.note_failed_input(summary.live.failure);
  if (findings.empty()) return {};
  const diagnose::Finding first = findings.front();
  findings.erase(findings.begin());
  diagnose::log_findings(arguments.input.string(), findings, "--");
  return Error{ErrorCode::kInvalidValue, cat(first.code, ": ", diagnose::text_of(first, "--")),
               arguments.input.string()};
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
  add_recording_options(verb.app(), check.recording, kRecordingOptions);
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

}  // namespace e2lf::cli
