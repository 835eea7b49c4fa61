// SPDX-License-Identifier: MIT
// e2lf video: recording -> frames
#include <chrono>
#include <optional>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/event_windows.h"
#include "e2lf/diagnose/hot_events.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/terminal/progress_bar.h"
#include "e2lf/video/video_model.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr int64_t kDefaultWindowUs = 40000;  // 25 frames a second

struct VideoArguments {
  fs::path input, output, model;
  std::optional<int64_t> window_us;
  std::optional<uint64_t> window_events;
  bool window_triggers = false;
  std::string tone = "auto", precision = "float32";
  cycles::WindowOptions window;  ///< its triggers
  int full_scale = 4;
  RecordingFlags recording;
};

cycles::WindowOptions window_options(const VideoArguments& arguments) {
  cycles::WindowOptions options = arguments.window;
  if (arguments.window_triggers) {
    options.kind = cycles::WindowKind::kTriggers;
  } else if (arguments.window_events) {
    options.kind = cycles::WindowKind::kCount;
    options.events = *arguments.window_events;
  } else {
    options.kind = cycles::WindowKind::kTime;
    options.duration_us = arguments.window_us.value_or(kDefaultWindowUs);
    const int64_t from_us = arguments.recording.open.from_us;
    if (from_us != INT64_MIN && !arguments.recording.is_relative) options.origin_us = from_us;
  }
  return options;
}

/// Makes a frame from each window: with the network, or else from its signed events.
struct FrameMaker {
  size_t height, width;
  float full_scale;  ///< a surplus of this many ON or OFF events is white or black
  std::optional<video::EventVideo> network = {};
  video::FrameTone tone = video::FrameTone::kNone;
  double network_s = 0.0;  ///< time that voxel grids and the network took

  Result<lightfield::ByteImage> make(const cycles::EventWindow& window) {
    lightfield::Image frame(width, height, 1);
    if (network) {
      const auto begin = std::chrono::steady_clock::now();
      E2LF_ASSIGN_OR_RETURN(frame.pixels,
                            network->next(cycles::voxelise(window.events, network->model().bins, height, width)));
      network_s += seconds_since(begin);
      video::apply_frame_tone(tone, frame.pixels);
    } else {
      frame.pixels = cycles::signed_counts(window.events, height, width);
      for (float& value : frame.pixels) value = 0.5F + 0.5F * value / full_scale;
    }
    return lightfield::to_bytes(frame);
  }
};

Result<FrameMaker> make_frame_maker(const VideoArguments& arguments, const recordings::RecordingInfo& info,
                                    RunRecord& record) {
  FrameMaker maker{info.height, info.width, static_cast<float>(arguments.full_scale)};
  if (arguments.model.empty()) return maker;
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(arguments.model));
  record.add_input(arguments.model, bytes);
  E2LF_ASSIGN_OR_RETURN(video::VideoModel model, video::decode_video_model(bytes, arguments.model.string()));
  maker.tone = model.tone;
  if (arguments.tone != "auto") {
    E2LF_ASSIGN_OR_RETURN(maker.tone, choice_of(arguments.tone, video::kFrameTones, "tone"));
  }
  record.resolve("tone", word_of(maker.tone, video::kFrameTones));
  E2LF_ASSIGN_OR_RETURN(const engine::Precision precision,
                        choice_of(arguments.precision, engine::kPrecisions, "precision"));
  E2LF_ASSIGN_OR_RETURN(maker.network,
                        video::EventVideo::create(std::move(model), info.height, info.width, {.precision = precision}));
  return maker;
}

struct VideoReport {
  uint64_t frames = 0, events = 0, empty = 0;
  diagnose::Findings findings = {};
  std::string table = "frame,begin_us,end_us,events\n";
};

Result<VideoReport> write_frames(cycles::WindowReader& windows, FrameMaker& maker, const fs::path& folder,
                                 ProgressBar& bar) {
  VideoReport report;
  diagnose::HotEvents hot(maker.height, maker.width);
  cycles::EventWindow window;
  const auto step = [&](size_t) -> Result<bool> {
    E2LF_ASSIGN_OR_RETURN(const bool more, windows.next(window));
    if (!more) return false;
    hot.add(window.events);
    E2LF_ASSIGN_OR_RETURN(const lightfield::ByteImage frame, maker.make(window));
    const auto number = static_cast<unsigned long long>(report.frames);
    E2LF_RETURN_IF_ERROR(lightfield::write_png(folder / formatted("frame_%06llu.png", number), frame));
    report.table += cat(report.frames, ",", window.begin_us, ",", window.end_us, ",", window.events.size(), "\n");
    report.events += window.events.size();
    report.empty += window.events.empty() ? 1 : 0;
    bar.update(++report.frames, 0);
    return true;
  };
  E2LF_RETURN_IF_ERROR(repeat_until_stopped(step));
  if (auto finding = hot.finding()) report.findings.push_back(*std::move(finding));
  return report;
}

Error no_frame_error(const VideoArguments& arguments, const cycles::WindowReader& windows) {
  const std::string input = arguments.input.string();
  if (arguments.window_triggers) {
    return fail(ErrorCode::kInvalidValue, input, "there are ", windows.triggers(),
                " triggers of the edge and input, and a frame needs two; choose ",
                "others with --edge and --channel, or give --window-us");
  }
  return fail(ErrorCode::kInvalidValue, input,
              "there are no events, so there are no frames; check --from-us and --to-us");
}

Result<std::unique_ptr<recordings::RecordingReader>> open_input(const VideoArguments& arguments) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(arguments.input));
  if (kind != FileKind::kRecording) {
    return other_kind_error(arguments.input, kind, "a recording of events");
  }
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(arguments.input, arguments.recording));
  if (reader->info().width == 0 || reader->info().height == 0) {
    return fail(ErrorCode::kInvalidValue, arguments.input,
                "the recording does not state the sensor size; give its width and height")
        .about("sensor_width");
  }
  return reader;
}

Json report_json(const VideoArguments& arguments, const VideoReport& report, const cycles::WindowReader& windows,
                 const FrameMaker& maker) {
  Json json = {{"frames", report.frames},
               {"empty_windows", report.empty},
               {"events", report.events},
               {"left_out", losses_json(windows.recording().summary())},
               {"findings", diagnose::to_json(report.findings)}};
  if (arguments.window_triggers) {
    json["triggers"] = windows.triggers();
    json["events_outside_of_windows"] = windows.events_outside();
  }
  if (maker.network) json["network_s"] = maker.network_s;
  return json;
}

/// Fails if an option would do nothing.
Result<void> check_uses(const VideoArguments& arguments) {
  const auto useless = [](const char* option, const char* needed) {
    return fail(ErrorCode::kInvalidValue, option, "this has no effect ", needed, " or leave it out");
  };
  const VideoArguments usual;
  if (!arguments.window_triggers) {
    constexpr const char* kNeeded = "without triggers; give --window-triggers,";
    if (arguments.window.edge != usual.window.edge) return useless("--edge", kNeeded);
    if (arguments.window.channel) return useless("--channel", kNeeded);
  }
  if (arguments.model.empty()) {
    constexpr const char* kNeeded = "on plain frames; give a model with -m,";
    if (arguments.tone != usual.tone) return useless("--tone", kNeeded);
    if (arguments.precision != usual.precision) return useless("--precision", kNeeded);
  } else if (arguments.full_scale != usual.full_scale) {
    return useless("--full-scale", "on the frames of a network; leave out -m,");
  }
  return {};
}

Result<void> make_video(const VideoArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_RETURN_IF_ERROR(check_uses(arguments));
  cycles::WindowOptions options = window_options(arguments);
  E2LF_ASSIGN_OR_RETURN(ResultFolder output, open_output_folder(arguments.output, verb));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(auto reader, open_input(arguments));
  E2LF_ASSIGN_OR_RETURN(FrameMaker maker, make_frame_maker(arguments, reader->info(), record));
  if (options.kind == cycles::WindowKind::kTime) record.resolve("window-us", options.duration_us);
  cycles::WindowReader windows(std::move(reader), std::move(options));
  record.end_step("open");
  ProgressBar bar("video", common.quiet, "frames");
  E2LF_ASSIGN_OR_RETURN(const VideoReport report, write_frames(windows, maker, output.path(), bar));
  hide_progress();
  warn_of_losses(arguments.input, windows.recording().summary());
  diagnose::log_findings(arguments.input.string(), report.findings);
  verb.set_failed_input(windows.recording().summary().live.failure);
  if (report.frames == 0) return no_frame_error(arguments, windows);
  E2LF_RETURN_IF_ERROR(write_file(output.path() / "frames.csv", report.table));
  record.end_step("frames");
  Json json = report_json(arguments, report, windows, maker);
  record.note("video", json);
  record.note("read_as", reading_json(windows.recording().info()));
  record.add_input(arguments.input);
  E2LF_RETURN_IF_ERROR(commit(output, record));
  json["output"] = arguments.output.string();
  print_result(common, json,
               cat(report.frames, " frames of ", report.events, " events in ", arguments.output.string(),
                   ": frame_000000.png ..., frames.csv, run.json\n"));
  return {};
}

void add_window_options(CLI::App& app, VideoArguments& video) {
  CLI::Option* const by_time =
      app.add_option("--window-us", video.window_us,
                     cat("duration of the events of each frame; without any window: ", kDefaultWindowUs))
          ->check(whole_number(1, int64_t{3'600'000'000}));
  CLI::Option* const by_count = app.add_option("--window-events", video.window_events, "number of events of each frame")
                                    ->check(whole_number(1))
                                    ->excludes(by_time);
  app.add_flag("--window-triggers", video.window_triggers, "make a frame of the events from each trigger to the next")
      ->excludes(by_time)
      ->excludes(by_count);
  add_choice(app, "--edge", video.window.edge, cycles::kTriggerEdges, "edge of the triggers: rising, falling or both");
  app.add_option("--channel", video.window.channel, "trigger input; default: all");
}

}  // namespace

int run_video(const std::vector<std::string>& arguments) {
  Verb verb("video",
            "Make grey frames from a recording, with a recurrent network or as sums of the signed events. Needs "
            "constant memory.",
            "e2lf video recording.raw -m firenet.safetensors -o out/frames --window-us 20000");
  VideoArguments video;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", video.input, "recording of events")->required();
  app.add_option("-o,--output", video.output, "folder to write: frame_000000.png ..., frames.csv, run.json")
      ->required();
  app.add_option("-m,--model", video.model,
                 "network that reconstructs frames (`e2lf model import --checkpoint`); without one, plain frames are "
                 "made: sums of signed events, grey for equally many ON and OFF events, white for more ON");
  add_window_options(app, video);
  add_choice(app, "--tone", video.tone, {"auto", "none", "robust", "standard", "exp-robust"},
             "tone of the network's frames: auto (as the model states), none, robust (1 % and 99 % of the pixels "
             "become black and white), standard (the extremes do) or exp-robust");
  add_count(app, "--full-scale", video.full_scale, 1, 1000000, "plain frames: surplus of ON events that is white");
  add_choice(app, "--precision", video.precision, {"float32", "bfloat16"},
             "arithmetic of the network: float32 or bfloat16");
  add_recording_options(app, video.recording);
  verb.stop_gently();
  return verb.run(arguments, [&] { return make_video(video, verb); });
}

}  // namespace e2lf::cli
