// SPDX-License-Identifier: MIT
// e2lf record: writes a live input to a file, byte for byte
#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/recording_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/program/run_record.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/open/open_named_recording.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct RecordArguments {
  fs::path input, output;
  double seconds = 0;  ///< 0 = until the input ends
  CameraFlags camera;
};

/// Returns the path of the camera's settings: x.bias beside x.raw. Fails if this file exists and does not belong to an
/// earlier recording of the same name.
Result<fs::path> bias_place(const RecordArguments& arguments, bool overwrite) {
  fs::path place = arguments.output;
  place.replace_extension(".bias");
  std::error_code error;
  if (!fs::exists(fs::symlink_status(place, error))) return place;
  const auto earlier = read_json(record_path_beside(arguments.output));
  const bool is_ours = earlier && earlier->contains("notes") && (*earlier)["notes"].is_object() &&
                       (*earlier)["notes"].value("biases", "") == place.filename().string();
  if (overwrite && is_ours) return place;
  return Error{ErrorCode::kExists,
               "the camera's settings would replace this file; move it away or choose another output", place.string()};
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
    E2LF_ASSIGN_OR_RETURN(bias_file, bias_place(arguments, verb.common().overwrite));
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
    const auto written = record.write(output.record_path(), verb);
    if (!written) log_warning(cat("without its record: ", written.error().text()));
    E2LF_RETURN_IF_ERROR(output.commit());
    if (!bias_file.empty()) E2LF_RETURN_IF_ERROR(write_file(bias_file, biases));
  }
  warn_of_losses(arguments.input, summary);
  if (summary.live.num_gaps > 0) {
    log_warning(cat(arguments.output.string(), ": data are missing at ", summary.live.num_gaps,
                    summary.live.num_gaps == 1 ? " place" : " places",
                    output.is_stream() ? "" : "; its record lists them"));
  }
  verb.note_failed_input(summary.live.failure);
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
  E2LF_ASSIGN_OR_RETURN(const recordings::CameraSetup setup, camera_setup(arguments.camera));
  OutputRules rules = output_rules(verb, {arguments.input});
  rules.streams = true;
  rules.recover = recordings::recover_recording({});
  E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(arguments.output, rules));
  // This is checked before the camera starts, because its data must not wait for it.
  if (!output.is_stream() && recordings::is_camera_name(arguments.input.string())) {
    E2LF_RETURN_IF_ERROR(bias_place(arguments, verb.common().overwrite));
  }
  RunRecord record("record");
  E2LF_ASSIGN_OR_RETURN(const auto sink, recordings::open_file_sink(output.path()));
  E2LF_ASSIGN_OR_RETURN(const auto source, recordings::open_live_bytes(arguments.input.string(), setup));
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> length(arguments.seconds);
  if (arguments.seconds > 0) source->end_at(begin + std::chrono::duration_cast<std::chrono::nanoseconds>(length));
  ProgressBar bar("record", verb.common().quiet, "bytes");
  E2LF_ASSIGN_OR_RETURN(Copied copied, copy_bytes(*source, *sink, bar.callback()));
  hide_progress();
  if (copied.bytes == 0 && copied.written) {
    return Error{ErrorCode::kTruncated, "the source sent nothing; check the sender", arguments.input.string()};
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
