// SPDX-License-Identifier: MIT
#include "e2lf/info/describe.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/info/page_parts.h"
#include "e2lf/learn/data/packed_data.h"
#include "e2lf/lightfield/epi.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/model/model.h"
#include "e2lf/model/summary.h"
#include "e2lf/report/chart.h"
#include "e2lf/video/video_model.h"

namespace e2lf::info {
namespace fs = std::filesystem;
namespace {

Json orientation_json(const std::optional<capture::Orientation>& views) {
  return views ? Json(capture::orientation_name(*views)) : Json();
}

/// Returns a histogram of the values in bins of equal width.
std::string histogram(const char* label, std::span<const float> values, float low, float high, size_t bins) {
  report::LineChart chart{label, "share, %", {{"", {}, /*is_filled=*/true}}};
  std::vector<double> counts(bins);
  const float width = std::max(high - low, 1e-6F) / static_cast<float>(bins);
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    const float bin = std::clamp((value - low) / width, 0.0F, static_cast<float>(bins - 1));
    counts[static_cast<size_t>(bin)] += 100.0 / static_cast<double>(values.size());
  }
  for (size_t i = 0; i < bins; ++i) {
    for (const size_t edge : {i, i + 1}) {
      chart.lines[0].points.push_back({static_cast<double>(low + width * static_cast<float>(edge)), counts[i]});
    }
  }
  return report::chart_svg(chart);
}

Result<void> show(const capture::EventImageFile& file, report::Page& page) {
  const capture::EventImages& first = file.cycles.front();
  page.heading("The first cycle").paragraph("Events of each transition: red is ON, blue is OFF, and grey is none.");
  E2LF_RETURN_IF_ERROR(add_pictures({{event_picture(first), "event images"}}, 1600, page));
  page.drawing(transition_bars(eval::event_statistics(first).events_per_pixel));
  constexpr float kMost = 16.5F;
  const std::vector<float> counts(first.values.begin(), first.values.end());
  page.drawing(histogram("ON minus OFF events of a pixel in a transition; values beyond 16 are counted at the ends",
                         counts, -kMost, kMost, 33));
  if (!file.setup.codes) return {};
  page.heading("Patterns");
  add_patterns(*file.setup.codes, page);
  return {};
}

Result<void> show(const lightfield::LightField& field, float low, float high, report::Page& page) {
  page.heading("Views");
  E2LF_RETURN_IF_ERROR(
      add_pictures({{lightfield::contact_sheet(field), "all views, in the order of the aperture"}}, 1600, page));
  page.heading("Parallax");
  E2LF_RETURN_IF_ERROR(add_pictures(
      {{lightfield::epi_picture(field, lightfield::middle_cut(field.shape())),
        "the middle view, with the EPIs of two cuts below and beside it, framed in the colours of the cuts"}},
      1200, page));
  page.heading("Values").drawing(histogram("value", field.data(), std::min(low, 0.0F), std::max(high, 1.0F), 128));
  return {};
}

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
  const auto show_patterns = [codes = model.codes](report::Page& page) -> Result<void> {
    if (codes) {
      page.heading("Patterns");
      add_patterns(*codes, page);
    }
    return {};
  };
  return Description{std::move(json), std::move(patterns), show_patterns};
}

/// Describes training data that `e2lf pack` wrote.
Result<Description> describe_packed_data(Safetensors file, const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const learn::PackedData data, learn::sort_packed_data(std::move(file), path.string()));
  Json light_fields = Json::array();
  for (const learn::PackedPicture& field : data.light_fields) {
    light_fields.push_back({{"name", field.name}, {"shape", field.pixels.shape}});
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
  E2LF_ASSIGN_OR_RETURN(capture::EventImageFile read, capture::read_event_images(path));
  const auto kept = std::make_shared<const capture::EventImageFile>(std::move(read));
  const capture::EventImageFile& file = *kept;
  const capture::EventImages& first = file.cycles.front();
  const capture::RecordedSetup& setup = file.setup;
  const eval::EventStatistics statistics = eval::event_statistics(first);
  Json json = {{"kind", "event images"},
               {"cycles", file.cycles.size()},
               {"transitions", first.count},
               {"height", first.height},
               {"width", first.width},
               {"codes", setup.codes.has_value()},
               {"orientation", orientation_json(setup.views)},
               {"first_cycle", eval::to_json(statistics)}};
  return Description{std::move(json), {}, [kept](report::Page& page) { return show(*kept, page); }};
}

/// Describes a measurement with intensity images.
Result<Description> describe_images(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::MeasurementFile file, capture::read_measurements(path));
  const capture::Measurement& first = file.cycles.front();
  const auto [low, high] = std::minmax_element(first.images.values.begin(), first.images.values.end());
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
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField read, lightfield::read_light_field(path, options));
  const auto light_field = std::make_shared<const lightfield::LightField>(std::move(read));
  const lightfield::Shape& shape = light_field->shape();
  E2LF_ASSIGN_OR_RETURN(const capture::Orientation stored, lightfield::stored_orientation(path));
  const auto [low, high] = std::minmax_element(light_field->data().begin(), light_field->data().end());
  Json json = {{"kind", "light field"},
               {"format", lightfield::kind_name(kind)},
               {"views", {shape.views_y, shape.views_x}},
               {"height", shape.height},
               {"width", shape.width},
               {"channels", shape.channels},
               {"stored_orientation", capture::orientation_name(stored)},
               {"min", *low},
               {"max", *high}};
  return Description{std::move(json), {}, [light_field, low = *low, high = *high](report::Page& page) {
                       return show(*light_field, low, high, page);
                     }};
}

/// Returns the names in a folder, sorted.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
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
  std::error_code error;
  const bool has_model = fs::exists(model, error);
  const bool has_curves = fs::exists(path / "curves.html", error);
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
  const auto frames =
      std::count_if(names.begin(), names.end(), [](const std::string& name) { return name.starts_with("frame_"); });
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
                     "run.json describes the run that made them; give one of them for more information\n"};
}

Result<Description> describe_cycles(const fs::path& path, const lightfield::ReadOptions& options) {
  const std::vector<fs::path> folders = lightfield::cycle_folders(path);
  E2LF_ASSIGN_OR_RETURN(Description first, describe_light_field(folders.front(), options));
  Json json = {{"kind", "cycles"}, {"cycles", folders.size()}, {"first_cycle", std::move(first.json)}};
  return Description{std::move(json), {}, std::move(first.show)};
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

}  // namespace

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

}  // namespace e2lf::info
