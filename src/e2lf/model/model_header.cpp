// SPDX-License-Identifier: MIT
// Converts the header of a model file; declared in model_parts.h.
#include <algorithm>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
namespace {

constexpr std::pair<InputKind, const char*> kInputKinds[] = {
    {InputKind::kCounts, "counts"},       {InputKind::kCumulative, "cumulative"}, {InputKind::kIntensity, "intensity"},
    {InputKind::kCamera, "camera"},       {InputKind::kImages, "images"},         {InputKind::kImageSum, "image-sum"},
    {InputKind::kLensArray, "lens-array"}};

constexpr const char* kMeasurement = "measurement";

bool is_of_light_fields(const Json& measurement) {
  return measurement.is_string() && (measurement == "" || capture::measurement_from_name(measurement));
}

Result<InputGroup> group_from_json(const Json& json, const std::string& location) {
  InputGroup group;
  std::string kind;
  OptionReader reader(json, location);
  reader.read("kind", kind).read("scale", group.scale);
  E2LF_RETURN_IF_ERROR(reader.finish());
  std::vector<std::string> names;
  for (const auto& [value, name] : kInputKinds) {
    names.emplace_back(name);
    if (kind == name) {
      group.kind = value;
      return group;
    }
  }
  return fail(ErrorCode::kUnsupported, reader.child_location("kind"), "unknown input \"", kind, "\"; known are ",
              join(names));
}

Result<std::vector<InputGroup>> input_from_json(const Json& json, const std::string& location) {
  if (!json.is_array()) return fail(ErrorCode::kFormat, location, "expected a list of inputs");
  std::vector<InputGroup> groups;
  for (size_t i = 0; i < json.size(); ++i) {
    E2LF_ASSIGN_OR_RETURN(const InputGroup group, group_from_json(json[i], cat(location, "[", i, "]")));
    groups.push_back(group);
  }
  return groups;
}

Result<capture::SensorConstants> constants_from_json(const Json& json, const std::string& location) {
  capture::SensorConstants constants;
  OptionReader reader(json, location);
  reader.read("eps", constants.eps)
      .read("tau", constants.tau)
      .read("sigma_w", constants.sigma_w)
      .read("sigma_z", constants.sigma_z)
      .read("sigma_i", constants.sigma_i);
  E2LF_RETURN_IF_ERROR(reader.finish());
  return constants;
}

/// Checks that the measurement stated in the file agrees with its input.
Result<void> check_measurement(const Model& model, const std::string& stated, const OptionReader& reader) {
  const auto needed = measurement_of(model.input);
  if (!needed) return Error{needed.error().code, needed.error().message, reader.child_location("input")};
  if (stated == capture::measurement_name(*needed)) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("the header states ", stated, ", but the inputs require ", capture::measurement_name(*needed),
                   "; make them agree"),
               reader.child_location(kMeasurement)};
}

/// The version is checked first, because another version has other keys.
Result<void> check_version(const Json& json, const std::string& location) {
  if (!json.is_object()) return fail(ErrorCode::kFormat, location, "expected an object; write { ... }");
  const Json version = json.value("format_version", Json());
  if (version == kFormatVersion) return {};
  return fail(ErrorCode::kUnsupported, location + ".format_version", "format version ",
              version.is_null() ? "(none)" : json_line(version),
              " is not supported; use a build that reads it, as this one reads ", kFormatVersion);
}

}  // namespace

Result<void> check_kind(const Json& header, const std::string& expected, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_version(header, location));
  const Json found = header.value(kMeasurement, Json(""));
  const bool is_video = found == kVoxelGrid, is_expected_video = expected == kVoxelGrid;
  if (!is_video && !is_of_light_fields(found)) {
    return fail(ErrorCode::kUnsupported, location + "." + kMeasurement, "the measurement ", json_line(found),
                " is not known; this build knows event-images, coded-images, hybrid, lens-array and ", kVoxelGrid,
                "; use a newer build");
  }
  if (is_video == is_expected_video) return {};
  return Error{ErrorCode::kUnsupported,
               is_video ? "this model reconstructs frames from voxel grids, not light fields; use it with `e2lf video`"
                        : "this model reconstructs light fields, not frames; use it with `e2lf reconstruct`",
               location + "." + kMeasurement};
}

const char* input_kind_name(InputKind kind) {
  return std::find_if(std::begin(kInputKinds), std::end(kInputKinds), [&](const auto& k) { return k.first == kind; })
      ->second;
}

size_t num_input_channels(InputKind kind, size_t num_patterns) {
  switch (kind) {
    case InputKind::kCounts:
    case InputKind::kCumulative:
    case InputKind::kIntensity:
      return num_patterns - 1;
    case InputKind::kCamera:
      return capture::conditioning_size(num_patterns);
    case InputKind::kImages:
      return num_patterns;
    case InputKind::kImageSum:
      return 1;
    case InputKind::kLensArray:
      return capture::kLensPixels * capture::kLensPixels;
  }
  return 0;
}

size_t num_input_channels(const std::vector<InputGroup>& groups, size_t num_patterns) {
  size_t channels = 0;
  for (const InputGroup& group : groups) channels += num_input_channels(group.kind, num_patterns);
  return channels;
}

Result<capture::MeasurementKind> measurement_of(const std::vector<InputGroup>& groups) {
  const auto has = [&](InputKind kind) {
    return std::any_of(groups.begin(), groups.end(), [kind](const InputGroup& group) { return group.kind == kind; });
  };
  const bool has_events =
      has(InputKind::kCounts) || has(InputKind::kCumulative) || has(InputKind::kIntensity) || has(InputKind::kCamera);
  const bool has_images = has(InputKind::kImages), has_sum = has(InputKind::kImageSum),
             has_lenses = has(InputKind::kLensArray);
  using capture::MeasurementKind;
  if (!has_images && !has_lenses) return has_sum ? MeasurementKind::kHybrid : MeasurementKind::kEventImages;
  if (has_images && !has_events && !has_sum && !has_lenses) return MeasurementKind::kCodedImages;
  if (has_lenses && !has_events && !has_sum && !has_images) return MeasurementKind::kLensArray;
  return Error{ErrorCode::kInvalidValue,
               "no measurement provides all of these inputs; use only images, only lens-array, or only inputs from "
               "events with or without "
               "image-sum",
               "input"};
}

bool is_conditioned_on_camera(const Model& model) {
  return std::any_of(model.input.begin(), model.input.end(),
                     [](const InputGroup& group) { return group.kind == InputKind::kCamera; });
}

Json header_to_json(const Model& model) {
  Json input = Json::array();
  for (const InputGroup& group : model.input) {
    input.push_back({{"kind", input_kind_name(group.kind)}, {"scale", json_number(group.scale)}});
  }
  Json header = {{"format_version", kFormatVersion},
                 {"name", model.name},
                 {"num_patterns", model.num_patterns},
                 {"views_y", model.views_y},
                 {"views_x", model.views_x},
                 {"event_model", model.event_model},
                 {"black_first", model.black_first},
                 {"constants",
                  {{"eps", json_number(model.constants.eps)},
                   {"tau", json_number(model.constants.tau)},
                   {"sigma_w", json_number(model.constants.sigma_w)},
                   {"sigma_z", json_number(model.constants.sigma_z)}}},
                 {"input", std::move(input)},
                 {"network", to_json(model.network)},
                 {"provenance", model.provenance}};
  // Older files do not state the measurement, which is then event images.
  const capture::MeasurementKind measurement = model.measurement();
  if (measurement != capture::MeasurementKind::kEventImages) {
    header[kMeasurement] = capture::measurement_name(measurement);
    header["constants"]["sigma_i"] = json_number(model.constants.sigma_i);
  }
  if (model.camera) header["camera"] = capture::to_json(*model.camera);
  const auto& [bfloat16_db, int16_db] = model.precision_loss;
  if (bfloat16_db) header["precision_loss"]["bfloat16_db"] = *bfloat16_db;
  if (int16_db) header["precision_loss"]["int16_db"] = *int16_db;
  return header;
}

Result<Model> header_from_json(const Json& json, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_kind(json, "", location));
  Model model;
  OptionReader reader(json, location);
  reader.read("name", model.name)
      .read("num_patterns", model.num_patterns)
      .read("views_y", model.views_y)
      .read("views_x", model.views_x)
      .read("event_model", model.event_model)
      .read("black_first", model.black_first);
  std::string measurement = capture::measurement_name(capture::MeasurementKind::kEventImages);
  reader.read(kMeasurement, measurement);
  (void)reader.child("format_version");
  const Json& constants = reader.child("constants");
  const Json& input = reader.child("input");
  const Json& network = reader.child("network");
  const Json& provenance = reader.child("provenance");
  const Json& camera = reader.child("camera");
  const Json& precision_loss = reader.child("precision_loss");
  E2LF_RETURN_IF_ERROR(reader.finish());
  E2LF_ASSIGN_OR_RETURN(model.constants, constants_from_json(constants, reader.child_location("constants")));
  E2LF_ASSIGN_OR_RETURN(model.input, input_from_json(input, reader.child_location("input")));
  E2LF_RETURN_IF_ERROR(check_measurement(model, measurement, reader));
  E2LF_ASSIGN_OR_RETURN(model.network, network_from_json(network, reader.child_location("network")));
  if (!camera.is_null()) {
    E2LF_ASSIGN_OR_RETURN(model.camera, capture::camera_from_json(camera, reader.child_location("camera")));
  }
  if (!precision_loss.is_null()) {
    OptionReader losses(precision_loss, reader.child_location("precision_loss"));
    losses.read("bfloat16_db", model.precision_loss.bfloat16_db).read("int16_db", model.precision_loss.int16_db);
    E2LF_RETURN_IF_ERROR(losses.finish());
  }
  if (!provenance.is_null()) model.provenance = provenance;
  return model;
}

}  // namespace e2lf::model
