// SPDX-License-Identifier: MIT
#include "e2lf/info/describe.h"

#include <algorithm>
#include <fstream>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/diagnose/hot_events.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/learn/data/packed_data.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/model/model.h"
#include "e2lf/recordings/event_counters.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/video/video_model.h"

namespace e2lf::info {
namespace fs = std::filesystem;
namespace {

Result<Description> describe_model(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const bool is_video, model::is_video_model(path));
  if (is_video) {
    E2LF_ASSIGN_OR_RETURN(const video::VideoModel model, video::read_video_model(path));
    Json json = video::summary_json(model);
    json["kind"] = "model of frames";
    return Description{std::move(json)};
  }
  E2LF_ASSIGN_OR_RETURN(const model::Model model, model::read_model(path));
  Json json = model::summary_json(model);
  json["kind"] = "model";
  std::string patterns = model.codes ? capture::codes_text(*model.codes) : std::string();
  return Description{std::move(json), std::move(patterns)};
}

/// Describes training data that `e2lf pack` wrote.
Result<Description> describe_packed_data(Safetensors file, const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const learn::PackedData data, learn::sort_packed_data(std::move(file), path.string()));
  Json light_fields = Json::array();
  for (const learn::PackedPicture& field : data.light_fields) {
    light_fields.push_back(
        {{"name", field.name}, {"shape", field.pixels.shape}, {"disparity", !field.disparity.shape.empty()}});
  }
  return Description{
      {{"kind", "training data"}, {"light_fields", std::move(light_fields)}, {"textures", data.textures.size()}}};
}

Result<Description> describe_safetensors(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(Safetensors file, read_safetensors(path));
  if (learn::is_packed_data(file)) return describe_packed_data(std::move(file), path);
  return describe_model(path);
}

Result<Description> describe_event_images(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::EventImageFile file, capture::read_event_images(path));
  const capture::EventImages& first = file.cycles.front();
  const capture::RecordedSetup& setup = file.setup;
  return Description{{{"kind", "event images"},
                      {"cycles", file.cycles.size()},
                      {"transitions", first.count},
                      {"height", first.height},
                      {"width", first.width},
                      {"codes", setup.codes.has_value()},
                      {"orientation", setup.views ? Json(capture::orientation_name(*setup.views)) : Json()},
                      {"first_cycle", eval::to_json(eval::event_statistics(first))}}};
}

/// Describes a measurement with intensity images.
Result<Description> describe_images(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::MeasurementFile file, capture::read_measurements(path));
  const capture::Measurement& first = file.cycles.front();
  const auto [low, high] = std::ranges::minmax_element(first.images.values);
  Json json = {{"kind", "measurement"},
               {"measurement", capture::measurement_name(first.kind)},
               {"cycles", file.cycles.size()},
               {"transitions", first.events.count},
               {"images", first.images.count},
               {"height", first.height()},
               {"width", first.width()},
               {"codes", file.setup.codes.has_value()},
               {"min", *low},
               {"max", *high}};
  if (first.events.count > 0) json["first_cycle"] = eval::to_json(eval::event_statistics(first.events));
  return Description{std::move(json)};
}

Result<Description> describe_light_field(const fs::path& path, const lightfield::ReadOptions& options) {
  E2LF_ASSIGN_OR_RETURN(const auto kind, lightfield::detect_kind(path));
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, lightfield::read_light_field(path, options));
  const lightfield::Shape& shape = light_field.shape();
  E2LF_ASSIGN_OR_RETURN(const capture::Orientation stored, lightfield::stored_orientation(path));
  const auto [low, high] = std::ranges::minmax_element(light_field.data());
  return Description{{{"kind", "light field"},
                      {"format", lightfield::kind_name(kind)},
                      {"views", {shape.views_y, shape.views_x}},
                      {"height", shape.height},
                      {"width", shape.width},
                      {"channels", shape.channels},
                      {"stored_orientation", capture::orientation_name(stored)},
                      {"min", *low},
                      {"max", *high}}};
}

/// Returns the names in a folder, sorted.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& path : paths_in(folder)) names.push_back(path.filename().string());
  return names;
}

/// Returns the number at the start of the last line; 0 if there is none.
uint64_t last_step(const fs::path& log) {
  std::ifstream in(log);
  uint64_t step = 0;
  for (std::string line; std::getline(in, line);) step = std::strtoull(line.c_str(), nullptr, 10);
  return step;
}

Result<Description> describe_training_run(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json config, read_json(path / "config.json"));
  const Json::json_pointer name_at("/name"), steps_at("/train/steps");
  const bool has_name = config.contains(name_at) && config[name_at].is_string();
  const bool has_steps = config.contains(steps_at) && config[steps_at].is_number_unsigned();
  const std::string name = has_name ? config[name_at].get<std::string>() : "model";
  const uint64_t steps = has_steps ? config[steps_at].get<uint64_t>() : 0, done = last_step(path / "log.csv");
  const fs::path model = path / (name + ".safetensors");
  const bool has_model = is_present(model);
  const bool has_curves = is_present(path / "curves.html");
  return Description{{{"kind", "training run"},
                      {"name", name},
                      {"steps", steps},
                      {"logged_steps", done},
                      {"model", has_model ? Json(model.string()) : Json()},
                      {"curves", has_curves ? Json((path / "curves.html").string()) : Json()}},
                     cat("`e2lf resume ", path.string(), "` continues it\n")};
}

Result<Description> describe_display(const fs::path& path) {
  const std::vector<std::string> names = names_in(path);
  const auto frames = std::ranges::count_if(names, [](const std::string& name) { return name.starts_with("frame_"); });
  return Description{{{"kind", "display"}, {"frames", frames}},
                     "contact_sheet.png shows the frames; schedule.csv is for the program that shows them, "
                     "schedule.json for --schedule, and codes.json for --codes\n"};
}

Result<Description> describe_results(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json record, read_json(path / "run.json"));
  const std::string verb = record.value("verb", "");
  std::vector<std::string> names = names_in(path);
  std::erase(names, "run.json");
  return Description{{{"kind", "results"}, {"verb", verb}, {"names", names}},
                     "run.json describes the run that produced these files; `e2lf info` describes each of them\n"};
}

Result<Description> describe_cycles(const fs::path& path, const lightfield::ReadOptions& options) {
  const std::vector<fs::path> folders = lightfield::cycle_folders(path);
  E2LF_ASSIGN_OR_RETURN(Description first, describe_light_field(folders.front(), options));
  return Description{{{"kind", "cycles"}, {"cycles", folders.size()}, {"first_cycle", std::move(first.json)}}};
}

Result<Description> describe_camera(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, capture::read_camera(path));
  Json json = {{"kind", "camera"}};
  json.update(capture::to_json(camera));
  return Description{std::move(json), "a camera file, for --camera\n"};
}

Result<Description> describe_schedule(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const cycles::Schedule schedule, cycles::read_schedule(path));
  Json shown = Json::array();
  for (const cycles::ScheduledPattern& pattern : schedule.patterns) {
    shown.push_back({{"name", pattern.name},
                     {"duration_us", pattern.duration_us},
                     {"overhead_us", pattern.overhead_us},
                     {"image", pattern.image ? Json(*pattern.image) : Json()}});
  }
  return Description{{{"kind", "schedule"},
                      {"patterns", schedule.size()},
                      {"cycle_us", schedule.cycle_us()},
                      {"images", schedule.num_images()},
                      {"views", schedule.views ? Json(capture::orientation_name(*schedule.views)) : Json()},
                      {"shown", std::move(shown)}},
                     "a schedule of a display, for --schedule\n"};
}

Result<Description> describe_codes(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::Codes codes, capture::read_codes(path));
  return Description{{{"kind", "codes"},
                      {"num_patterns", codes.num_patterns},
                      {"views", {codes.views_y, codes.views_x}},
                      {"black_first", capture::is_black_first(codes)},
                      {"light_efficiency", capture::light_efficiency(codes)}},
                     cat("aperture patterns, for --codes\n", capture::codes_text(codes))};
}

Description describe_record(const fs::path& path, const Json& record) {
  const std::string verb = record.value("verb", "?");
  Json json = {{"kind", "record"}};
  for (const char* key : {"verb", "version", "folder", "options", "inputs"}) json[key] = record.value(key, Json());
  return {std::move(json), cat("`e2lf ", verb, " --config ", path.string(), "` repeats the run\n")};
}

Description describe_keys(const Json& settings) {
  std::vector<std::string> keys;
  for (const auto& entry : settings.items()) keys.push_back(entry.key());
  const bool is_training = settings.contains("train");
  return {{{"kind", is_training ? "training settings" : "settings"}, {"keys", keys}},
          is_training ? "for `e2lf train`\n" : "for --config if the keys are names of options\n"};
}

/// Describes lines "value % name" of a .bias file.
Result<Description> describe_biases(const fs::path& path) {
  constexpr size_t kMostBytes = 65536;
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> content, read_head(path, kMostBytes));
  return Description{{{"kind", "biases"}},
                     cat("settings of a sensor, for --biases:\n", std::string(content.begin(), content.end()))};
}

/// Describes a camera, a schedule, patterns, the record of a run, settings of a training, or biases.
Result<Description> describe_settings(const fs::path& path) {
  if (path.extension() == ".bias") return describe_biases(path);
  if (path.extension() != ".json") return describe_codes(path);
  E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
  if (is_our_record(path)) return describe_record(path, json);
  if (json.contains("event_model")) return describe_camera(path);
  const Json patterns = json.value("patterns", Json());
  if (!patterns.is_array()) return describe_keys(json);
  return !patterns.empty() && patterns[0].is_object() ? describe_schedule(path) : describe_codes(path);
}

}  // namespace

std::string Description::text() const {
  report::Table table = report::facts_table(json);
  for (auto& row : table.rows) {
    for (report::Cell& cell : row) cell.text = printable(cell.text);
  }
  return report::table_text(table) + printable(note);
}

Result<Description> describe(FileKind kind, const fs::path& path, const DescribeOptions& options) {
  switch (kind) {
    case FileKind::kModel:
      return describe_safetensors(path);
    case FileKind::kEventImages:
      return describe_event_images(path);
    case FileKind::kImages:
      return describe_images(path);
    case FileKind::kCycles:
      return describe_cycles(path, options.light_field);
    case FileKind::kRecording:
      return describe_recording(path, options);
    case FileKind::kTrainingRun:
      return describe_training_run(path);
    case FileKind::kDisplay:
      return describe_display(path);
    case FileKind::kResults:
      return describe_results(path);
    case FileKind::kSettings:
      return describe_settings(path);
    case FileKind::kLightField:
      break;
  }
  return describe_light_field(path, options.light_field);
}

Result<Description> describe(const fs::path& path, const DescribeOptions& options) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  return describe(kind, path, options);
}

namespace {

/// The size in px of the smallest sensor that contains all events.
struct Extent {
  size_t width = 0, height = 0;

  void add(const recordings::EventColumns& events) {
    for (const uint16_t x : events.x) width = std::max<size_t>(width, x + 1U);
    for (const uint16_t y : events.y) height = std::max<size_t>(height, y + 1U);
  }
};

Json assumptions_json(const recordings::RecordingInfo& info) {
  Json texts = Json::array();
  for (const recordings::Assumption& assumption : info.assumptions) texts.push_back(assumption_text(assumption));
  return texts;
}

Json to_json(const recordings::RecordingInfo& info, const recordings::DecodeSummary& summary,
             const recordings::DuplicateCounter& duplicates, size_t hot_pixels, const diagnose::TriggerInputs& triggers,
             const Extent& extent, Json parts) {
  const double duration_s = static_cast<double>(summary.last_t_us - summary.first_t_us) * 1e-6;
  Json json = {{"kind", "recording"},
               {"format", info.format},
               {"width", info.width},
               {"height", info.height},
               {"duration_s", duration_s},
               {"events_per_s", duration_s > 0 ? static_cast<double>(summary.events()) / duration_s : 0.0}};
  Json counts = summary_json(summary);
  const Json left_out = std::move(counts["left_out"]);
  counts.erase("left_out");
  json.update(counts);
  json["duplicates"] = duplicates.duplicates();
  json["hot_pixels"] = hot_pixels;
  json["trigger_channels"] = diagnose::to_json(triggers);
  json["extents"] = {{"width", extent.width}, {"height", extent.height}};
  json["assumptions"] = assumptions_json(info);
  json["read_as"] = reading_json(info);
  json["left_out"] = left_out;
  json["parts"] = std::move(parts);
  json["header"] = header_json(info);
  return json;
}

std::string duplicates_text(const recordings::DuplicateCounter& counter) {
  if (counter.duplicates() == 0) return "";
  return cat(formatted("%.3g", 100 * counter.share()),
             " % of the events are exact duplicates of others, and count twice\n");
}

}  // namespace

Result<Description> describe_recording(const fs::path& path, const DescribeOptions& options) {
  recordings::OpenOptions open = options.recording;
  open.counts_reports = true;
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_named_recording(path.string(), open));
  diagnose::TriggerInputs triggers;
  Extent extent;
  recordings::DuplicateCounter duplicates;
  diagnose::HotEvents hot(reader->info().height, reader->info().width);
  recordings::DecodeSummary summary;
  recordings::EventBatch batch;
  Json parts_json = Json::array();
  for (bool more_parts = true; more_parts;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (more) {
      diagnose::add(batch.triggers, triggers);
      extent.add(batch.events);
      duplicates.add(batch.events);
      hot.add(batch.events);
      if (options.on_batch) options.on_batch(batch);
      if (options.progress) options.progress(summary.events() + reader->summary().events(), 0);
      continue;
    }
    const recordings::DecodeSummary part = reader->summary();
    summary.append(part);
    parts_json.push_back({{"events", part.events()},
                          {"triggers", part.triggers},
                          {"first_t_us", part.first_t_us},
                          {"last_t_us", part.last_t_us}});
    E2LF_ASSIGN_OR_RETURN(more_parts, reader->next_part());
  }
  const auto hot_finding = hot.finding();
  Description description{
      to_json(reader->info(), summary, duplicates, hot.count(), triggers, extent, std::move(parts_json)),
      duplicates_text(duplicates) + (hot_finding ? diagnose::text_of(*hot_finding) + "\n" : "")};
  description.failure = summary.live.failure;
  return description;
}

}  // namespace e2lf::info
