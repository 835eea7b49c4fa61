// SPDX-License-Identifier: MIT
// e2lf info: what a file or folder is
#include <cstdio>

#include "e2lf/base/safetensors.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/cycle_options.h"
#include "e2lf/cli/info_recording.h"
#include "e2lf/cli/verb.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/report.h"
#include "e2lf/events/event_images.h"
#include "e2lf/events/live/camera.h"
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
  E2LF_ASSIGN_OR_RETURN(const model::Model model, model::read_model(path));
  Json json = model::summary_json(model);
  json["kind"] = "model";
  return Description{model::summary_text(model), std::move(json)};
}

Result<Description> describe_event_images(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const events::EventImageFile file, events::read_event_images(path));
  const events::EventImages& first = file.cycles.front();
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

Result<Description> describe_light_field(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto kind, lightfield::detect_kind(path));
  lightfield::ReadOptions options;
  options.views_y.count = options.views_x.count = 0;  // all views that are stored
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

bool holds_event_images(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return fs::exists(path / "event_image_00000.npy", error);
  if (path.extension() == ".npz") {
    const auto arrays = read_npz(path);
    return arrays.ok() && arrays->count("events") == 1 && arrays->at("events").fields.empty();
  }
  return false;
}

Result<void> print_info(const fs::path& path, const RecordingInfoOptions& recording, const Verb& verb) {
  std::error_code error;
  const bool is_live = path == "-" || events::is_camera_name(path.string());
  if (!is_live && !fs::exists(path, error)) {
    return Error{ErrorCode::kNotFound, "there is no such file or folder; check the path", path.string()};
  }
  Result<Description> description = Description{};
  if (is_live) {
    return print_recording_info(path, recording, verb.common());
  } else if (path.extension() == ".safetensors") {
    description = describe_model(path);
  } else if (holds_event_images(path)) {
    description = describe_event_images(path);
  } else if (lightfield::detect_kind(path)) {
    description = describe_light_field(path);
  } else if (fs::is_directory(path, error)) {
    return Error{ErrorCode::kFormat,
                 "the folder holds neither event images (event_image_00000.npy ...) nor views of a light field; name "
                 "what is in it",
                 path.string()};
  } else {
    return print_recording_info(path, recording, verb.common());
  }
  E2LF_ASSIGN_OR_RETURN(const Description found, std::move(description));
  std::printf("%s", verb.common().json ? (found.json.dump(2) + "\n").c_str() : found.text.c_str());
  return {};
}

}  // namespace

int run_info(const std::vector<std::string>& arguments) {
  Verb verb("info", "Say what a file or folder is: a recording, event images, a light field or a model.",
            "e2lf info recording.raw --plot rate.svg");
  fs::path path;
  RecordingInfoOptions recording;
  verb.app().add_option("path,-i,--input", path, "file or folder")->required();
  verb.app().add_option("--plot", recording.plot, "recordings: write the event rate over time as an SVG picture");
  verb.app().add_option("--event-format,--format", recording.format,
                        "recordings: the format, where the file does not tell");
  add_time_options(verb.app(), recording.from_us, recording.to_us);
  verb.stop_gently();
  return verb.run(arguments, [&] { return print_info(path, recording, verb); });
}

}  // namespace e2lf::cli
