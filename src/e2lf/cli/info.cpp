// SPDX-License-Identifier: MIT
// e2lf info: what a file or folder is
#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/capture/event_images.h"
#include "e2lf/cli/file_kind.h"
#include "e2lf/cli/info_recording.h"
#include "e2lf/cli/light_field_flags.h"
#include "e2lf/cli/number_check.h"
#include "e2lf/cli/verb.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/json_text.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/model/model.h"
#include "e2lf/model/summary.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// What info prints: text for people, JSON for scripts.
struct Description {
  std::string text;
  Json json;
};

Result<Description> describe_model(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const bool is_video, model::is_video_model(path));
  if (is_video) {
    E2LF_ASSIGN_OR_RETURN(const model::VideoModel model, model::read_video_model(path));
    Json json = model::summary_json(model);
    json["kind"] = "model of frames";
    return Description{model::summary_text(model), std::move(json)};
  }
  E2LF_ASSIGN_OR_RETURN(const model::Model model, model::read_model(path));
  Json json = model::summary_json(model);
  json["kind"] = "model";
  return Description{model::summary_text(model), std::move(json)};
}

/// Data to train on, as `e2lf pack` writes it.
std::optional<Description> describe_packed_data(const Safetensors& file) {
  size_t textures = 0;
  Json light_fields = Json::array();
  std::string text;
  for (const auto& [name, tensor] : file.tensors) {
    const bool is_light_field = name.starts_with("lightfield/") && tensor.shape.size() == 4;
    if (!is_light_field && !name.starts_with("texture/")) return std::nullopt;
    textures += is_light_field ? 0 : 1;
    if (!is_light_field) continue;
    light_fields.push_back({{"name", name.substr(11)}, {"shape", tensor.shape}});
    text += cat("  ", name.substr(11), ": ", shape_text(tensor.shape), "\n");
  }
  if (light_fields.empty() && textures == 0) return std::nullopt;
  text = cat("data to train on: ", light_fields.size(), " light fields, ", textures, " photographs\n", text);
  return Description{std::move(text),
                     {{"kind", "training data"}, {"light_fields", std::move(light_fields)}, {"textures", textures}}};
}

Result<Description> describe_safetensors(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Safetensors file, read_safetensors(path));
  if (auto packed = describe_packed_data(file)) return std::move(*packed);
  return describe_model(path);
}

Result<Description> describe_event_images(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const capture::EventImageFile file, capture::read_event_images(path));
  const capture::EventImages& first = file.cycles.front();
  const eval::EventStatistics statistics = eval::event_statistics(first);
  Json json = {{"kind", "event images"},
               {"cycles", file.cycles.size()},
               {"transitions", first.transitions},
               {"height", first.height},
               {"width", first.width},
               {"codes", file.codes.has_value()},
               {"first_cycle", eval::to_json(statistics)}};
  std::string text = cat("event images: ", file.cycles.size(), " cycle", file.cycles.size() == 1 ? "" : "s", " of ",
                         first.transitions, " transitions, ", first.width, "x", first.height, " px, codes ",
                         file.codes ? "included" : "not included", "\nevents per pixel in the first cycle:");
  for (const double count : statistics.events_per_pixel) text += cat(" ", count);
  text += cat(", total ", statistics.total_events_per_pixel, "\n");
  return Description{std::move(text), std::move(json)};
}

Result<Description> describe_light_field(const fs::path& path, const LightFieldFlags& flags) {
  E2LF_ASSIGN_OR_RETURN(const auto kind, lightfield::detect_kind(path));
  lightfield::ReadOptions options = read_options(flags);
  options.range = lightfield::RangePolicy::kKeep;
  options.colour = true;
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, lightfield::read_light_field(path, options));
  const lightfield::Shape& shape = light_field.shape();
  const auto [low, high] = std::minmax_element(light_field.data().begin(), light_field.data().end());
  Json json = {{"kind", "light field"},
               {"format", lightfield::kind_name(kind)},
               {"views", {shape.views_y, shape.views_x}},
               {"height", shape.height},
               {"width", shape.width},
               {"channels", shape.channels},
               {"min", *low},
               {"max", *high}};
  return Description{cat("light field (", lightfield::kind_name(kind), "): ", shape.views_y, "x", shape.views_x,
                         " views of ", shape.width, "x", shape.height, " px, ", shape.channels == 1 ? "grey" : "colour",
                         ", values ", *low, "..", *high, "\n"),
                     std::move(json)};
}

Result<Description> describe_cycles(const fs::path& path, const LightFieldFlags& flags) {
  const std::vector<fs::path> folders = lightfield::cycle_folders(path);
  E2LF_ASSIGN_OR_RETURN(Description first, describe_light_field(folders.front(), flags));
  Json json = {{"kind", "cycles"}, {"cycles", folders.size()}, {"first_cycle", std::move(first.json)}};
  return Description{cat("light fields of ", folders.size(), " cycle", folders.size() == 1 ? "" : "s", "; ",
                         folders.front().filename().string(), ": ", first.text),
                     std::move(json)};
}

Result<Description> describe(FileKind kind, const fs::path& path, const LightFieldFlags& light_field) {
  switch (kind) {
    case FileKind::kModel:
      return describe_safetensors(path);
    case FileKind::kEventImages:
      return describe_event_images(path);
    case FileKind::kCycles:
      return describe_cycles(path, light_field);
    case FileKind::kLightField:
    case FileKind::kRecording:
      break;
  }
  return describe_light_field(path, light_field);
}

Result<void> print_info(const fs::path& path, const RecordingInfoOptions& recording, const LightFieldFlags& light_field,
                        const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField && kind != FileKind::kCycles) {
    E2LF_RETURN_IF_ERROR(verb.refuse_options(kLightFieldOptions, kind_text(kind)));
  }
  if (kind == FileKind::kRecording) return print_recording_info(path, recording, verb.common());
  E2LF_RETURN_IF_ERROR(verb.refuse_options(kRecordingOptions, kind_text(kind)));
  E2LF_ASSIGN_OR_RETURN(const Description found, describe(kind, path, light_field));
  if (!recording.plot.empty()) {
    return Error{ErrorCode::kInvalidValue, "this is no recording, there is no event rate to plot; leave --plot out",
                 path.string()};
  }
  std::printf("%s", verb.common().json ? json_text(found.json).c_str() : found.text.c_str());
  return {};
}

}  // namespace

int run_info(const std::vector<std::string>& arguments) {
  Verb verb("info", "Say what a file or folder is: a recording, event images, a light field or a model.",
            "e2lf info recording.raw --plot rate.svg");
  fs::path path;
  RecordingInfoOptions recording;
  verb.app().add_option("path,-i,--input", path, "file or folder")->required();
  verb.app()
      .add_option("--plot", recording.plot, "recordings: write the event rate over time as an SVG picture")
      ->check(svg_name());
  add_recording_options(verb.app(), recording.flags, kRecordingOptions);
  LightFieldFlags light_field{.views = 0};
  add_light_field_options(verb.app(), light_field, /*has_views=*/true);
  verb.stop_gently();
  return verb.run(arguments, [&] { return print_info(path, recording, light_field, verb); });
}

}  // namespace e2lf::cli
