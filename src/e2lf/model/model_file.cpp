// SPDX-License-Identifier: MIT
// Reads and writes model files; declared in model.h.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
namespace {

constexpr const char* kCodesTensor = "aperture.codes";
constexpr std::string_view kAnyPatterns = "any.";

/// Returns the values of a tensor, which must have this shape and, unless `any_type` is set, a type of float. `remedy`
/// says what to do if it has another shape.
Result<std::vector<float>> values_of(const Safetensors& tensors, const std::string& name,
                                     const std::vector<size_t>& shape, const std::string& file, const char* remedy,
                                     bool any_type = false) {
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, tensors.find(name, file));
  const std::string location = cat(file, ": ", name);
  if (!any_type && tensor->type != "f4" && tensor->type != "bf16") {
    return fail(ErrorCode::kUnsupported, location, "the element type ", type_name(*tensor),
                " is not supported; save it as F32 or BF16");
  }
  if (tensor->shape == shape) return tensor->to_float(location);
  return fail(ErrorCode::kShape, location, "the values have shape ", shape_text(tensor->shape), " instead of ",
              shape_text(shape), "; ", remedy);
}

/// Weights of at least this many values are stored once if two layers have the same.
constexpr size_t kLeastShared = 1024;
constexpr const char* kSharedWeights = "shared_weights";

/// Leaves out weights that an earlier layer has, too. Returns the names of those that stand for them, by name. Each
/// stands for one other at most, so that a reader needs no more than twice the memory of the file.
Json take_shared_weights(Safetensors& tensors, const std::vector<WeightShape>& weights) {
  Json shared = Json::object();
  std::map<std::pair<std::vector<size_t>, std::vector<uint8_t>>, std::string> stored;
  for (const WeightShape& weight : weights) {
    const auto found = tensors.tensors.find(weight.name);
    if (found->second.num_elements() < kLeastShared) continue;
    auto node = stored.extract({found->second.shape, found->second.bytes});
    if (node.empty()) {
      stored[{found->second.shape, found->second.bytes}] = weight.name;
      continue;
    }
    shared[weight.name] = node.mapped();
    tensors.tensors.erase(found);
  }
  return shared;
}

/// Adds the weights that are stored as those of another layer.
Result<void> add_shared_weights(Safetensors& tensors, const Json& shared, const std::string& file) {
  if (shared.is_null()) return {};
  const std::string location = cat(file, ": ", kMetadataKey, ": $.", kSharedWeights);
  if (!shared.is_object()) return fail(ErrorCode::kFormat, location, "expected an object; write { ... }");
  std::set<std::string> used;
  for (const auto& [name, source] : shared.items()) {
    if (!source.is_string()) return fail(ErrorCode::kFormat, location + "." + name, "expected the name of a tensor");
    const auto from = source.get<std::string>();
    if (tensors.tensors.contains(name) || shared.contains(from) || !used.insert(from).second) {
      return fail(ErrorCode::kInvalidValue, location + "." + name,
                  "weights that are stored or shared already are shared; share each stored tensor once");
    }
    E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, tensors.find(from, file));
    tensors.tensors[name] = Tensor(*tensor);
  }
  return {};
}

constexpr const char* kMeasurement = "measurement";

bool is_of_light_fields(const Json& measurement) {
  return measurement.is_string() &&
         (measurement == "" || choice_of(measurement.get<std::string>(), capture::kMeasurementKinds));
}

/// The fields of the header that are plain. `has_images` adds the constant of intensity images.
template <typename AnyModel, typename Visitor>
void visit_header(AnyModel& model, Visitor& visit, bool has_images) {
  E2LF_VISIT(model, visit, name, num_patterns, views_y, views_x, event_model, black_first);
  visit.section("constants", [&](auto& inner) {
    E2LF_VISIT(model.constants, inner, eps, tau, sigma_w, sigma_z);
    if (has_images) inner("sigma_i", model.constants.sigma_i);
  });
  visit.list("input", model.input, [](auto& group, auto& inner) {
    inner.choice("kind", group.kind, kInputKinds, ErrorCode::kUnsupported);
    inner("scale", group.scale);
  });
}

/// Checks that the measurement stated in the file agrees with its input.
Result<void> check_measurement(const Model& model, const std::string& stated, const OptionReader& reader) {
  const auto needed = measurement_of(model.input);
  if (!needed) return Error{needed.error().code, needed.error().message, reader.child_location("input")};
  if (stated == capture::measurement_name(*needed)) return {};
  return fail(ErrorCode::kInvalidValue, reader.child_location(kMeasurement), "the header states ", stated,
              ", but the inputs require ", capture::measurement_name(*needed), "; make them agree");
}

Json codes_summary(const capture::Codes& codes) {
  Json efficiency = Json::array();
  for (const float share : capture::light_efficiency(codes)) efficiency.push_back(json_number(share));
  return {{"binary", capture::is_binary(codes)}, {"light_efficiency", std::move(efficiency)}};
}

}  // namespace

Result<Json> header_of(const Safetensors& tensors, const std::string& file) {
  const auto metadata = tensors.metadata.find(kMetadataKey);
  if (metadata == tensors.metadata.end()) {
    return fail(ErrorCode::kFormat, file,
                "not an e2lf model (its metadata has no \"e2lf\"); `e2lf model import` creates one from the weights of "
                "the paper or of a published network");
  }
  return parse_json(metadata->second, cat(file, ": ", kMetadataKey));
}

Result<Weights> weights_from_tensors(const Network& network, const Safetensors& tensors, const std::string& file) {
  Weights weights;
  for (const WeightShape& wanted : weight_shapes(network)) {
    E2LF_ASSIGN_OR_RETURN(weights[wanted.name],
                          values_of(tensors, wanted.name, wanted.shape, file, "store the weights of this network"));
  }
  for (const auto& entry : tensors.tensors) {
    if (entry.first == kCodesTensor || entry.first.starts_with(kAnyPatterns) || weights.contains(entry.first)) continue;
    return fail(ErrorCode::kFormat, cat(file, ": ", entry.first),
                "the tensor belongs to no layer of the network; remove it or describe its layer");
  }
  return weights;
}

namespace {

Result<std::map<std::string, SharedWeights>> any_patterns_from_tensors(const Safetensors& tensors,
                                                                       const std::string& file) {
  std::map<std::string, SharedWeights> weights;
  for (const auto& [name, tensor] : tensors.tensors) {
    if (!name.starts_with(kAnyPatterns)) continue;
    SharedWeights& shared = weights[name.substr(kAnyPatterns.size())];
    shared.shape = tensor.shape;
    E2LF_ASSIGN_OR_RETURN(shared.values, values_of(tensors, name, tensor.shape, file, ""));
  }
  return weights;
}

}  // namespace

Result<Model> decode_model(std::span<const uint8_t> bytes, const std::string& file) {
  E2LF_ASSIGN_OR_RETURN(Safetensors tensors, decode_safetensors(bytes, file));
  E2LF_ASSIGN_OR_RETURN(const Json json, header_of(tensors, file));
  E2LF_ASSIGN_OR_RETURN(Model model, header_from_json(json, cat(file, ": ", kMetadataKey, ": $")));
  E2LF_RETURN_IF_ERROR(add_shared_weights(tensors, json.value(kSharedWeights, Json()), file));
  E2LF_ASSIGN_OR_RETURN(model.weights, weights_from_tensors(model.network, tensors, file));
  E2LF_ASSIGN_OR_RETURN(model.any_patterns, any_patterns_from_tensors(tensors, file));
  if (tensors.tensors.contains(kCodesTensor)) {
    const std::vector<size_t> shape = {model.num_patterns, model.views_y, model.views_x};
    E2LF_ASSIGN_OR_RETURN(auto values,
                          values_of(tensors, kCodesTensor, shape, file, "store the patterns of this model"));
    model.codes.emplace(model.num_patterns, model.views_y, model.views_x);
    model.codes->values = std::move(values);
  }
  E2LF_RETURN_IF_ERROR(validate(model, file));
  return model;
}

Result<Model> read_model(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return decode_model(bytes, path.string());
}

Result<bool> is_video_model(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, read_safetensors(path));
  E2LF_ASSIGN_OR_RETURN(const Json json, header_of(tensors, path.string()));
  return json.is_object() && json.value("measurement", Json()) == kVoxelGrid;
}

Result<void> write_model(const std::filesystem::path& path, const Model& model, WeightStorage storage) {
  E2LF_RETURN_IF_ERROR(validate(model, path.string()));
  Safetensors tensors;
  const auto store = [&](const std::string& name, const std::vector<size_t>& shape, const std::vector<float>& values) {
    tensors.tensors[name] =
        storage == WeightStorage::kBfloat16 ? make_bfloat16_tensor(shape, values) : make_npy<float>(shape, values);
  };
  const std::vector<WeightShape> shapes = weight_shapes(model.network);
  for (const WeightShape& tensor : shapes) store(tensor.name, tensor.shape, model.weights.at(tensor.name));
  for (const auto& [name, weights] : model.any_patterns) store(cat(kAnyPatterns, name), weights.shape, weights.values);
  Json header = header_to_json(model);
  if (Json shared = take_shared_weights(tensors, shapes); !shared.empty()) header[kSharedWeights] = std::move(shared);
  tensors.metadata[kMetadataKey] = json_line(header);
  if (model.codes) {
    tensors.tensors[kCodesTensor] =
        make_npy<float>({model.codes->num_patterns, model.codes->views_y, model.codes->views_x}, model.codes->values);
  }
  return write_safetensors(path, tensors);
}

Result<Model> import_release(const std::filesystem::path& folder) {
  constexpr size_t kPatterns = 4, kViews = 64;  // 8 rows of 8, numbered row by row
  const auto network_path = folder / "RecNet.safetensors", codes_path = folder / "AcqNet.safetensors";
  Model model;
  model.name = "coded-e2lf-release";
  model.num_patterns = kPatterns;
  model.input = {{InputKind::kCounts, 1.0F / 8.0F}};
  model.network = recnet(kPatterns - 1, kViews);
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, read_safetensors(network_path));
  E2LF_ASSIGN_OR_RETURN(model.weights, weights_from_tensors(model.network, tensors, network_path.string()));
  E2LF_ASSIGN_OR_RETURN(const Safetensors codes, read_safetensors(codes_path));
  model.codes.emplace(kPatterns, 8, 8);
  E2LF_ASSIGN_OR_RETURN(model.codes->values, values_of(codes, "mask_4x64", {kPatterns, kViews}, codes_path.string(),
                                                       "give the released file", /*any_type=*/true));
  model.provenance = {
      {"source", "released weights of the Coded-E2LF paper (Baseline+BF+RA, N = 4)"},
      {"licence", "MIT, see the release"},
      {"imported_from", {"RecNet.safetensors", "AcqNet.safetensors"}},
  };
  E2LF_RETURN_IF_ERROR(validate(model, folder.string()));
  return model;
}

Result<void> check_kind(const Json& header, bool is_video, const std::string& location) {
  if (!header.is_object()) return fail(ErrorCode::kFormat, location, "expected an object; write { ... }");
  // The version is checked first, because another version has other keys.
  const Json version = header.value("format_version", Json());
  if (version != kFormatVersion) {
    return fail(ErrorCode::kUnsupported, location + ".format_version", "format version ",
                version.is_null() ? "(none)" : json_line(version),
                " is not supported; use a build that reads it, as this one reads ", kFormatVersion);
  }
  const Json found = header.value(kMeasurement, Json(""));
  if (found != kVoxelGrid && !is_of_light_fields(found)) {
    return fail(ErrorCode::kUnsupported, location + "." + kMeasurement, "the measurement ", json_line(found),
                " is not known; this build knows event-images, coded-images, hybrid, lens-array and ", kVoxelGrid,
                "; use a newer build");
  }
  if ((found == kVoxelGrid) == is_video) return {};
  return fail(ErrorCode::kUnsupported, location + "." + kMeasurement,
              !is_video ? "this model reconstructs frames from voxel grids, not light fields; use it with `e2lf video`"
                        : "this model reconstructs light fields, not frames; use it with `e2lf reconstruct`");
}

size_t num_input_channels(InputKind kind, size_t num_patterns) {
  switch (kind) {
    case InputKind::kCounts:
    case InputKind::kCumulative:
    case InputKind::kLevel:
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
  const bool has_events = std::any_of(groups.begin(), groups.end(), [](const InputGroup& group) {
    return is_of_counts(group) || group.kind == InputKind::kCamera;
  });
  const bool has_images = has(InputKind::kImages), has_sum = has(InputKind::kImageSum),
             has_lenses = has(InputKind::kLensArray);
  using capture::MeasurementKind;
  if (!has_images && !has_lenses) return has_sum ? MeasurementKind::kHybrid : MeasurementKind::kEventImages;
  if (has_images && !has_events && !has_sum && !has_lenses) return MeasurementKind::kCodedImages;
  if (has_lenses && !has_events && !has_sum && !has_images) return MeasurementKind::kLensArray;
  return fail(ErrorCode::kInvalidValue, "input",
              "no measurement provides all of these inputs; use only images, only lens-array, or only inputs from "
              "events with or without "
              "image-sum");
}

bool is_conditioned_on_camera(const Model& model) {
  return std::any_of(model.input.begin(), model.input.end(),
                     [](const InputGroup& group) { return group.kind == InputKind::kCamera; });
}

Json header_to_json(const Model& model) {
  const capture::MeasurementKind measurement = model.measurement();
  const bool has_images = measurement != capture::MeasurementKind::kEventImages;
  FieldWriter writer;
  writer("format_version", kFormatVersion);
  visit_header(model, writer, has_images);
  writer("network", to_json(model.network));
  writer("provenance", model.provenance);
  Json header = std::move(writer).json();
  // Older files do not state the measurement, which is then event images.
  if (has_images) header[kMeasurement] = capture::measurement_name(measurement);
  if (model.camera) header["camera"] = capture::to_json(*model.camera);
  const auto& [bfloat16_db, int16_db] = model.precision_loss;
  if (bfloat16_db) header["precision_loss"]["bfloat16_db"] = *bfloat16_db;
  if (int16_db) header["precision_loss"]["int16_db"] = *int16_db;
  return header;
}

Result<Model> header_from_json(const Json& json, const std::string& location) {
  E2LF_RETURN_IF_ERROR(check_kind(json, /*is_video=*/false, location));
  Model model;
  OptionReader reader(json, location);
  visit_header(model, reader, /*has_images=*/true);
  std::string measurement = capture::measurement_name(capture::MeasurementKind::kEventImages);
  reader.read(kMeasurement, measurement);
  (void)reader.child("format_version");
  (void)reader.child(kSharedWeights);
  const Json& network = reader.child("network");
  const Json& provenance = reader.child("provenance");
  const Json& camera = reader.child("camera");
  reader.section("precision_loss",
                 [&](OptionReader& losses) { E2LF_VISIT(model.precision_loss, losses, bfloat16_db, int16_db); });
  E2LF_RETURN_IF_ERROR(reader.finish());
  E2LF_RETURN_IF_ERROR(check_measurement(model, measurement, reader));
  E2LF_ASSIGN_OR_RETURN(model.network, network_from_json(network, reader.child_location("network")));
  if (!camera.is_null()) {
    E2LF_ASSIGN_OR_RETURN(model.camera, capture::camera_from_json(camera, reader.child_location("camera")));
  }
  if (!provenance.is_null()) model.provenance = provenance;
  return model;
}

Json summary_json(const Model& model) {
  Json json = header_to_json(model);
  json["measurement"] = capture::measurement_name(model.measurement());
  json["network"] = network_summary(model.network);
  json["codes"] = model.codes ? codes_summary(*model.codes) : Json();
  json["any_patterns"] = is_for_any_patterns(model);
  // The provenance comes last.
  json.erase("provenance");
  json["provenance"] = model.provenance;
  return json;
}

}  // namespace e2lf::model
