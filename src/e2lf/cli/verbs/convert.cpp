// SPDX-License-Identifier: MIT
// e2lf convert: between event formats, between formats of event images, or between light-field formats
#include "e2lf/recordings/convert.h"

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/options.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct ConvertArguments {
  fs::path input, output;
  std::string format;
  bool shift_time = false, invert_polarity = false, colour = false;
  RecordingFlags recording;
  LightFieldFlags light_field;
};

Result<void> convert_light_field(const ConvertArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  lightfield::ReadOptions read = unchanged_options(arguments.light_field);
  read.colour = arguments.colour;
  lightfield::WriteOptions write;
  E2LF_ASSIGN_OR_RETURN(write.format, arguments.format.empty() ? lightfield::format_of_path(arguments.output)
                                                               : lightfield::parse_format(arguments.format));
  std::optional<ResultFolder> folder;
  std::optional<OutputFile> file;
  if (lightfield::is_folder_format(write.format)) {
    E2LF_ASSIGN_OR_RETURN(folder, open_output_folder(arguments.output, verb));
  } else {
    E2LF_ASSIGN_OR_RETURN(file, open_output(arguments.output, verb));
  }
  RunRecord record(verb, {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field,
                        read_with_progress(arguments.input, read, common.quiet));
  ProgressBar bar("write", common.quiet);
  bar.update(0, 1);
  E2LF_RETURN_IF_ERROR(folder ? lightfield::write_views(folder->path(), light_field, write.format, bar.callback())
                              : lightfield::write_light_field(file->path(), light_field, write));
  record.end_step("convert");
  E2LF_RETURN_IF_ERROR(folder ? commit(*folder, record) : commit(*file, record));
  hide_progress();
  const lightfield::Shape& shape = light_field.shape();
  print_result(common, {{"views", {shape.views_y, shape.views_x}}, {"height", shape.height}, {"width", shape.width}},
               cat(shape.views_y, "x", shape.views_x, " views of ", shape.width, "x", shape.height, " px in ",
                   arguments.output.string(), "\n"));
  return {};
}

/// Writes the record of a converted recording, with the patterns and the camera of the input, and with the orientation
/// of the views changed by `given`.
Result<void> write_record(RunRecord& record, const fs::path& input, const OrientationFlags& given,
                          const recordings::RecordingReader& reader, const OutputFile& output) {
  record.add_input(input);
  record.note("left_out", losses_json(reader.summary()));
  record.note("live", live_json(reader.summary()));
  record.note("sensor", sensor_json(reader.summary()));
  record.note(reading_notes(input, reader.info()));
  E2LF_ASSIGN_OR_RETURN(capture::RecordedSetup setup, pipeline::recorded_setup(input, reader.info()));
  setup.views = given.after(setup.views);
  record.note(pipeline::setup_notes(setup, output.path()));
  return record.write(output.record_path());
}

struct ConvertedPart {
  fs::path named;  ///< its final path
  OutputFile output;
  recordings::ConvertReport report;
};

/// Returns NAME.raw, or NAME_2.raw for the second part.
fs::path path_of_part(fs::path output, size_t number) {
  if (number > 1) output.replace_filename(cat(output.stem().string(), "_", number, output.extension().string()));
  return output;
}

Result<ConvertedPart> create_part(const ConvertArguments& arguments, const recordings::Codec& codec, size_t number,
                                  const Verb& verb) {
  const fs::path named = path_of_part(arguments.output, number);
  const OutputRules rules = recording_output_rules(verb, codec);
  E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(named, rules));
  if (number > 1 && output.is_stream()) {
    return fail(ErrorCode::kUnsupported, arguments.output,
                "a stream can take only one part of the recording; give a file");
  }
  if (output.is_stream() && !arguments.light_field.orientation.value().is_upright()) {
    return fail(ErrorCode::kUnsupported, arguments.output,
                "a stream does not state the orientation of the views; write a file, or give the option to the program "
                "that reads the stream");
  }
  return ConvertedPart{named, std::move(output), {}};
}

/// Converts the recording up to its end, or up to where the clock starts again.
Result<void> convert_part(const ConvertArguments& arguments, recordings::RecordingReader& reader, ConvertedPart& part,
                          const Verb& verb) {
  RunRecord record(verb);
  ProgressBar bar("convert", verb.common().quiet, "events");
  E2LF_ASSIGN_OR_RETURN(part.report, recordings::convert_recording(reader, part.output.path(),
                                                                   {.format = arguments.format,
                                                                    .invert_polarity = arguments.invert_polarity,
                                                                    .progress = bar.callback()}));
  hide_progress();
  record.end_step("convert");
  return part.output.is_stream()
             ? Result<void>{}
             : write_record(record, arguments.input, arguments.light_field.orientation, reader, part.output);
}

Json part_json(const ConvertedPart& part) {
  const recordings::ConvertReport& report = part.report;
  fs::path trigger_file = report.trigger_file;
  if (!trigger_file.empty()) trigger_file = part.named.parent_path() / trigger_file;
  return {{"file", part.named.string()},
          {"events", report.events},
          {"triggers", report.triggers},
          {"lost_triggers", report.lost_triggers},
          {"trigger_file", trigger_file.string()},
          {"left_out", losses_json(report.summary)},
          {"restarts", restarts_json(report.summary)},
          {"sensor_events_in", report.summary.sensor_events_in},
          {"sensor_events_sent", report.summary.sensor_events_sent},
          {"sorted", report.summary.out_of_order},
          {"warnings", report.warnings}};
}

std::string part_text(const ConvertedPart& part) {
  const std::string sensor = recordings::sensor_text(part.report.summary);
  return cat(part.report.events, " events and ", part.report.triggers, " triggers in ", part.named.string(),
             sorted_text(part.report.summary), "\n",
             sensor.empty() ? "" : cat("the sensor ", sensor, "; its counts are not in the output\n"));
}

Result<void> convert_events(const ConvertArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(const recordings::Codec* codec, recordings::codec_to_write(arguments.output, arguments.format));
  E2LF_ASSIGN_OR_RETURN(recordings::OpenOptions open, open_options(arguments.input, arguments.recording, true));
  // Before a stream is opened, because it cannot be repeated.
  std::vector<ConvertedPart> parts;
  E2LF_ASSIGN_OR_RETURN(ConvertedPart first, create_part(arguments, *codec, 1, verb));
  parts.push_back(std::move(first));
  // A replay can be repeated.
  if (codec->is_written_at_end && is_live(arguments.input) &&
      recordings::file_of_recording(arguments.input.string()).empty()) {
    log_warning(cat(arguments.output.string(),
                    ": this format is written at the end of a recording, so that nothing is left after a ",
                    "crash; record to .raw to be safe"));
  }
  open.counts_reports = true;
  open.time = arguments.shift_time ? recordings::TimeOrigin::kZero : recordings::TimeOrigin::kAbsolute;
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_named_recording(arguments.input.string(), open));
  log_assumptions(*reader);
  for (bool more = true; more;) {
    E2LF_RETURN_IF_ERROR(convert_part(arguments, *reader, parts.back(), verb));
    E2LF_ASSIGN_OR_RETURN(more, reader->next_part());
    if (!more) break;
    E2LF_ASSIGN_OR_RETURN(ConvertedPart next, create_part(arguments, *codec, parts.size() + 1, verb));
    parts.push_back(std::move(next));
  }
  Json json;
  for (ConvertedPart& part : parts) {
    E2LF_RETURN_IF_ERROR(part.output.commit());
    warn_of_losses(arguments.input, part.report.summary);
    verb.set_failed_input(part.report.summary.live.failure);
    if (!common.json) print_result(common, {}, part_text(part), part.output.text());
    json["parts"].push_back(part_json(part));
  }
  const fs::path next = path_of_part(arguments.output, parts.size() + 1);
  if (open.restart == recordings::RestartPolicy::kSplit && fs::exists(next)) {
    log_warning(cat(next.string(), " is not a part of this recording; it was there before"));
  }
  if (parts.size() == 1) json = part_json(parts.front());
  if (common.json) print_result(common, json, "", parts.front().output.text());
  return {};
}

/// Fails unless --format, or else the extension of the output, is that of event images.
Result<void> require_npz(const ConvertArguments& arguments) {
  const std::string extension =
      arguments.format.empty() ? arguments.output.extension().string() : cat(".", arguments.format);
  if (extension == ".npz") return {};
  return fail(ErrorCode::kUnsupported, arguments.input,
              "these are event images, which are written as .npz; signed integers of 8 or 16 bits are taken for "
              "counts, so store a light field as uint16 or float32");
}

Result<void> convert_event_images(const ConvertArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_RETURN_IF_ERROR(require_npz(arguments));
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb));
  RunRecord record(verb, {arguments.input});
  E2LF_ASSIGN_OR_RETURN(capture::EventImageFile file, capture::read_event_images(arguments.input));
  if (const OrientationFlags& given = arguments.light_field.orientation; !given.value().is_upright()) {
    file.setup.views = given.after(file.setup.views);
  }
  E2LF_RETURN_IF_ERROR(capture::write_event_images(output.path(), file));
  record.end_step("convert");
  E2LF_RETURN_IF_ERROR(commit(output, record));
  const capture::EventImages& first = file.cycles.front();
  print_result(
      common,
      {{"cycles", file.cycles.size()}, {"transitions", first.count}, {"height", first.height}, {"width", first.width}},
      cat(file.cycles.size(), " cycles of ", first.count, " event images of ", first.width, "x", first.height,
          " px in ", arguments.output.string(), "\n"));
  return {};
}

Result<void> convert(const ConvertArguments& arguments, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(arguments.input));
  if (kind == FileKind::kRecording) {
    E2LF_RETURN_IF_ERROR(verb.refuse_options({kLightFieldOptions}, kind_text(kind)));
    return convert_events(arguments, verb);
  }
  if (kind == FileKind::kLightField || kind == FileKind::kEventImages) {
    E2LF_RETURN_IF_ERROR(verb.refuse_options(kOptionsOfRecordings, kind_text(kind)));
    if (kind == FileKind::kLightField) return convert_light_field(arguments, verb);
    E2LF_RETURN_IF_ERROR(verb.refuse_options({kLightFieldOptions}, kind_text(kind)));
    return convert_event_images(arguments, verb);
  }
  if (kind == FileKind::kCycles) return lightfield::detect_kind(arguments.input).error();
  const bool is_model = kind == FileKind::kModel;
  if (!is_model && kind != FileKind::kImages) {
    return other_kind_error(arguments.input, kind, "a recording, event images or a light field");
  }
  return fail(
      ErrorCode::kUnsupported, arguments.input,
      is_model ? cat("this is ", kind_text(kind), "; other programs take it as ONNX, which `e2lf model export` writes")
               : cat("there is no other format for ", kind_text(kind), "; other programs read .npz"));
}

}  // namespace

int run_convert(const std::vector<std::string>& arguments) {
  Verb verb("convert", "Convert a recording, event images or a light field to another format.",
            "e2lf convert recording.raw recording.hdf5");
  ConvertArguments conversion;
  CLI::App& app = verb.app();
  app.add_option(
         "input,-i,--input", conversion.input,
         "recording (or - for a pipe, tcp://127.0.0.1:PORT, camera://NAME, replay:FILE), event images or light field")
      ->required();
  app.add_option("output,-o,--output", conversion.output,
                 "file or folder to write; its extension determines the format")
      ->required();
  app.add_option("--format", conversion.format,
                 "format of the output: evt3, evt2, evt2.1, dat, hdf5, csv, npz for recordings; npz for event images; "
                 "png, png16, npy, h5 for light fields");
  app.add_flag("--shift-time", conversion.shift_time, "let times begin at 0 instead of the time of the sensor")
      ->group(kRecordingOptions);
  app.add_flag("--invert-polarity", conversion.invert_polarity, "exchange ON and OFF events")->group(kRecordingOptions);
  app.add_flag("--colour", conversion.colour, "keep colour")->group(kLightFieldOptions);
  add_recording_options(app, conversion.recording);
  add_light_field_options(app, conversion.light_field, /*has_views=*/true);
  add_orientation_options(app, conversion.light_field.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return convert(conversion, verb); });
}

}  // namespace e2lf::cli
