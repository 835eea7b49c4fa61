// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/network_choice.h"

#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/whole_cycle.h"
#include "e2lf/cli/flags/camera_option.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

Result<std::optional<model::Model>> bundled_network(const capture::Codes& codes,
                                                    const std::optional<capture::SensorProfile>& camera,
                                                    RunRecord& record) {
  const bool has_physical_pixels = camera && camera->is_pixel();
  const std::vector<const char*> names = has_physical_pixels ? std::vector{"e2lf-n4-camera", "e2lf-n4-cycle-camera"}
                                                             : std::vector{"e2lf-n4", "e2lf-n8", "e2lf-n4-cycle"};
  for (const char* name : names) {
    const auto path = bundled_file(cat("models/", name, ".safetensors"));
    if (!path) continue;
    RunRecord unused("");
    E2LF_ASSIGN_OR_RETURN(auto model, read_named_model({.model = *path, .codes = {}}, unused));
    if (!model->codes || *model->codes != codes) continue;
    record.add_input(*path);
    record.resolve("model", name);
    log_info(cat("no model named: taking ", model->name, ", which was trained for these patterns and ",
                 has_physical_pixels ? "physical pixels" : "the paper's event model"));
    return model;
  }
  return std::optional<model::Model>();
}

Result<std::optional<model::Model>> find_bundled_network(const fs::path& events, const CodesSource& source,
                                                         const RecordedSetup& setup,
                                                         const std::optional<capture::SensorProfile>& camera,
                                                         RunRecord& record) {
  std::optional<capture::Codes> codes = setup.codes;
  if (!source.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(codes, read_patterns(source.codes));
  }
  if (!codes) {
    return Error{ErrorCode::kInvalidValue,
                 "nothing says which patterns the camera showed; give the model that was trained for them with -m",
                 events.string()};
  }
  E2LF_ASSIGN_OR_RETURN(auto model, bundled_network(*codes, camera, record));
  if (!model) {
    return Error{ErrorCode::kNotFound,
                 "no bundled network was trained for these patterns; give one that was with -m, or use --method "
                 "inversion",
                 events.string()};
  }
  return model;
}

Result<CycleFlags> wanted_cycles(CycleFlags flags, const CodesSource& source,
                                 const std::optional<model::Model>& model) {
  std::optional<capture::Codes> codes = model ? model->codes : std::nullopt;
  if (model) flags.num_wanted = model->num_patterns;
  if (!source.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(codes, read_patterns(source.codes));
    if (!model) flags.num_wanted = codes->num_patterns;
  }
  if (codes && codes->num_patterns >= 2) {
    flags.usual_patterns = capture::codes_of_whole_cycle(*codes).value_or(*codes).num_patterns;
  }
  return flags;
}

bool are_patterns_told(const std::optional<KnownCodes>& known) {
  return known && (known->origin == CodesOrigin::kGiven || known->origin == CodesOrigin::kEvents);
}

void warn_of_assumed_patterns(const fs::path& events, const std::string& whose) {
  log_warning(cat("nothing in ", events.string(), " says which patterns the camera showed: those of ", whose,
                  " are assumed, and nothing confirms it"));
}

void tell_patterns(const fs::path& events, const model::Model& model, const std::optional<KnownCodes>& known,
                   RunRecord& record) {
  const bool is_told = are_patterns_told(known);
  const bool are_the_models = is_told && model.codes && *model.codes == known->codes;
  const char* told_by = !is_told ? "nothing" : known->origin == CodesOrigin::kGiven ? "--codes" : "the events' file";
  record.note("patterns", {{"told_by", told_by}, {"are_the_models", are_the_models}});
  if (are_the_models) return;
  if (!is_told) return warn_of_assumed_patterns(events, model.name);
  log_warning(model.codes
                  ? cat("the events were made with other patterns than ", model.name,
                        " was trained for: the light field will be wrong; use their model, or --method inversion")
                  : cat(model.name, " does not say which patterns it was trained for: nothing confirms that ",
                        "they are those of the events"));
}

Result<std::optional<capture::SensorProfile>> camera_of_events(const std::string& named, const RecordedSetup& setup,
                                                               RunRecord& record) {
  if (!named.empty()) {
    E2LF_ASSIGN_OR_RETURN(capture::SensorProfile camera, load_camera(named, record));
    record.note("camera_told_by", "--camera");
    return std::optional(std::move(camera));
  }
  if (setup.camera) {
    record.note("camera", capture::to_json(*setup.camera));
    record.note("camera_told_by", "the events' file");
  }
  return setup.camera;
}

void tell_camera(const std::optional<capture::SensorProfile>& camera, model::Model& model, RunRecord& record) {
  if (model::is_told_the_camera(model)) {
    if (camera) {
      model.camera = camera;
    } else if (model.camera) {
      record.note("camera", capture::to_json(*model.camera));
      record.note("camera_told_by", "the model");
    }
  } else if (camera && camera->is_pixel()) {
    log_warning(cat("the events are those of physical pixels (", camera->name, "), which ", model.name,
                    " has never seen: the light field will be wrong; use a network that is told the camera, such as ",
                    "e2lf-n4-camera"));
  }
}

}  // namespace e2lf::cli
