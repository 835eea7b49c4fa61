// SPDX-License-Identifier: MIT
// Describes files of settings for `e2lf info`; declared in describe.h.
#include <cmath>

#include "e2lf/base/printable.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cli/output/print.h"
#include "e2lf/cli/verbs/describe.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

std::string views_line(const std::optional<capture::Orientation>& views) {
  return views ? cat("views: ", capture::orientation_name(*views), "\n") : "";
}

Result<Description> describe_camera(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, capture::read_camera(path));
  Json json = capture::to_json(camera);
  std::string text =
      cat("camera file, for --camera: ", printable(camera.name), ", event model ", camera.event_model, "\n");
  for (const auto& [key, constant] : json["constants"].items()) {
    const double value = constant.value("value", 0.0), uncertainty = constant.value("uncertainty", 0.0);
    text += formatted("%-18s %10.4g", key.c_str(), value);
    if (uncertainty > 0) text += cat(", uncertain by ", std::round(1000 * uncertainty) / 10, " %");
    text += "\n";
  }
  std::vector<std::string> transmissions;
  for (const float transmission : camera.transmission) transmissions.push_back(cat(transmission));
  if (!transmissions.empty()) text += cat("transmission of the active patterns: ", join(transmissions), "\n");
  text += views_line(camera.views);
  json["kind"] = "camera";
  return Description{std::move(text), std::move(json)};
}

Result<Description> describe_schedule(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const cycles::Schedule schedule, cycles::read_schedule(path));
  std::string text =
      cat("schedule of a display, for --schedule: ", schedule.size(), " patterns in ",
          static_cast<double>(schedule.cycle_us()) * 1e-3, " ms, ", schedule.num_images(), " event images\n");
  for (const cycles::ScheduledPattern& pattern : schedule.patterns) {
    text += cat(printable(pattern.name), ": ", pattern.duration_us, " us, then ", pattern.overhead_us, " us; ",
                pattern.image ? cat("event image ", *pattern.image) : "not used", "\n");
  }
  text += views_line(schedule.views);
  return Description{std::move(text),
                     {{"kind", "schedule"},
                      {"patterns", schedule.size()},
                      {"cycle_us", schedule.cycle_us()},
                      {"images", schedule.num_images()}}};
}

Result<Description> describe_codes(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::Codes codes, capture::read_codes(path));
  return Description{
      cat("aperture patterns, for --codes: ", codes.num_patterns, " of ", codes.views_y, "x", codes.views_x,
          capture::is_black_first(codes) ? ", black first\n" : ", NOT black first\n", capture::codes_text(codes)),
      {{"kind", "codes"},
       {"num_patterns", codes.num_patterns},
       {"views", {codes.views_y, codes.views_x}},
       {"light_efficiency", capture::light_efficiency(codes)}}};
}

Description describe_record(const fs::path& path, const Json& record) {
  const std::string verb = printable(record.value("verb", "?"));
  std::string text = cat("record of `e2lf ", verb, "`, version ", printable(record.value("version", "?")), ", run in ",
                         printable(record.value("folder", "?")), "\n");
  const Json options = record.value("options", Json::object());
  for (const auto& [key, value] : options.items()) {
    text +=
        cat("--", printable(key), " ", printable(value.is_string() ? value.get<std::string>() : value.dump()), "\n");
  }
  const Json inputs = record.value("inputs", Json::array());
  for (const Json& input : inputs) {
    if (input.is_object()) text += cat("read ", printable(input.value("path", "?")), "\n");
  }
  text += cat("`e2lf ", verb, " --config ", printable(path.string()), "` repeats the run\n");
  return {std::move(text), {{"kind", "record"}, {"verb", verb}, {"options", options}, {"inputs", inputs}}};
}

Description describe_keys(const Json& settings) {
  std::vector<std::string> keys;
  for (const auto& entry : settings.items()) keys.push_back(printable(entry.key()));
  const bool is_training = settings.contains("train");
  return {is_training ? cat("settings of a training, for `e2lf train`: ", join(keys), "\n")
                      : cat("settings, for --config if their keys are names of options: ", join(keys), "\n"),
          {{"kind", is_training ? "training settings" : "settings"}, {"keys", keys}}};
}

/// Describes lines "value % name" of a .bias file.
Result<Description> describe_biases(const fs::path& path) {
  constexpr size_t kMostBytes = 65536;
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> content, read_head(path, kMostBytes));
  const std::string text(content.begin(), content.end());
  return Description{cat("settings of a sensor, for --biases:\n", printable(text)), {{"kind", "biases"}}};
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

}  // namespace e2lf::cli
