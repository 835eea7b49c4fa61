// SPDX-License-Identifier: MIT
// Reads and writes model files; declared in model.h.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/model/composition.h"
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
  if (!any_type && tensor->type != "f4" && tensor->type != "f2" && tensor->type != "bf16") {
    return fail(ErrorCode::kUnsupported, location, "the element type ", type_name(*tensor),
                " is not supported; save it as F32, F16 or BF16");
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

namespace fs = std::filesystem;

constexpr const char *kComposedOf = "composed_of", *kShareOfFullScale = "share_of_full_scale";

Result<void> take_codes(const Safetensors& tensors, const std::string& file, Model& model) {
  if (!tensors.tensors.contains(kCodesTensor)) return {};
  const std::vector<size_t> shape = {model.num_patterns, model.views_y, model.views_x};
  E2LF_ASSIGN_OR_RETURN(auto values, values_of(tensors, kCodesTensor, shape, file, "store the patterns of this model"));
  model.codes.emplace(model.num_patterns, model.views_y, model.views_x);
  model.codes->values = std::move(values);
  return {};
}

/// Decodes a model that holds its own weights. Its disparity works at two scales if the header states the share of the
/// full one, or with `share` instead.
Result<Model> decode_own_weights(Safetensors tensors, const Json& json, const std::string& file,
                                 const std::optional<float>& share) {
  const std::string location = cat(file, ": ", kMetadataKey, ": $");
  E2LF_ASSIGN_OR_RETURN(Model model, header_from_json(json, location));
  E2LF_RETURN_IF_ERROR(add_shared_weights(tensors, json.value(kSharedWeights, Json()), file));
  E2LF_ASSIGN_OR_RETURN(model.weights, weights_from_tensors(model.network, tensors, file));
  E2LF_ASSIGN_OR_RETURN(model.any_patterns, any_patterns_from_tensors(tensors, file));
  E2LF_RETURN_IF_ERROR(take_codes(tensors, file, model));
  E2LF_RETURN_IF_ERROR(validate(model, file));
  const Json stated = json.value(kShareOfFullScale, Json());
  if (stated.is_null() && !share) return model;
  if (!stated.is_number()) {
    return fail(ErrorCode::kFormat, cat(location, ".", kShareOfFullScale),
                "expected a number; state one if the network works at two scales, and none in a guide otherwise");
  }
  return at_two_scales(std::move(model), share.value_or(stated.get<float>()));
}

/// Returns the file of a part of a composed model: the one of this name beside it, or else the bundled one.
Result<fs::path> find_part(const std::string& name, const fs::path& folder, const std::string& location) {
  const fs::path beside = folder / cat(name, kBundledModels.extension);
  const bool is_name = !name.empty() && name.find('/') == std::string::npos;
  if (is_name && !folder.empty() && is_file(beside)) return beside;
  if (auto bundled = bundled_file_named(kBundledModels, name)) return std::move(*bundled);
  return fail(ErrorCode::kNotFound, location, "the model ", name,
              ", of which this one is composed, is neither beside it nor among the bundled models; put it beside it");
}

/// Returns the header of a part, which must not be composed itself.
Result<Json> header_of_part(const Safetensors& tensors, const fs::path& part, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(Json json, header_of(tensors, part.string()));
  if (!json.is_object() || !json.contains(kComposedOf)) return json;
  return fail(ErrorCode::kUnsupported, location, "the model ", part.stem().string(),
              " is composed itself; name one that is not");
}

Result<Model> read_part(const fs::path& part, const std::string& location, const std::optional<float>& share) {
  E2LF_ASSIGN_OR_RETURN(Safetensors tensors, read_safetensors(part));
  E2LF_ASSIGN_OR_RETURN(const Json json, header_of_part(tensors, part, location));
  return decode_own_weights(std::move(tensors), json, part.string(), share);
}

/// The content of a file that states of which models it is composed.
struct Composition {
  std::string name;
  Guide guide;
  PrecisionLoss loss;
  fs::path views, disparity;  ///< the files of the parts
  std::string location;       ///< of the parts, in errors
  /// Whether the file holds a network of moved pictures, in place of the name of one of views.
  [[nodiscard]] bool has_own_network() const { return guide.views.empty(); }
};

Result<Composition> read_composition(const Json& json, const std::string& file, const fs::path& folder) {
  const std::string location = cat(file, ": ", kMetadataKey, ": $");
  E2LF_RETURN_IF_ERROR(check_kind(json, /*is_video=*/false, location));
  Composition found;
  found.location = cat(location, ".", kComposedOf);
  OptionReader parts(json.at(kComposedOf), found.location);
  E2LF_VISIT(found.guide, parts, views, disparity, weak_texture, share_of_full_scale);
  E2LF_RETURN_IF_ERROR(parts.finish());
  E2LF_ASSIGN_OR_RETURN(found.disparity, find_part(found.guide.disparity, folder, found.location + ".disparity"));
  if (found.has_own_network()) return found;
  E2LF_ASSIGN_OR_RETURN(found.views, find_part(found.guide.views, folder, found.location + ".views"));
  OptionReader reader(json, location);
  reader.read("name", found.name);
  (void)reader.child("format_version");
  (void)reader.child(kComposedOf);
  reader.section("precision_loss",
                 [&](OptionReader& losses) { E2LF_VISIT(found.loss, losses, bfloat16_db, int16_db); });
  E2LF_RETURN_IF_ERROR(reader.finish());
  return found;
}

Result<Model> compose(const Composition& of, const std::string& file) {
  E2LF_ASSIGN_OR_RETURN(Model views, read_part(of.views, of.location + ".views", std::nullopt));
  E2LF_ASSIGN_OR_RETURN(Model disparity,
                        read_part(of.disparity, of.location + ".disparity", of.guide.share_of_full_scale));
  const bool is_open = views.codes != disparity.codes && (!views.codes || is_for_any_patterns(disparity));
  if (is_open && !is_depth_network(disparity)) {
    return fail(ErrorCode::kInvalidValue, of.location + ".disparity", disparity.name,
                " gives views; name a network of disparity");
  }
  Result<Model> model = Model();
  if (is_open) {
    views.open_guide = std::make_shared<const OpenGuide>(OpenGuide{of.guide, std::move(disparity)});
    model = std::move(views);
  } else {
    model = guided(std::move(views), std::move(disparity), of.guide);
  }
  if (!model) return Error{model.error().code, cat(model.error().location, ": ", model.error().message), of.location};
  model->name = of.name;
  model->precision_loss = of.loss;
  model->parts = {of.views, of.disparity};
  if (!is_open) E2LF_RETURN_IF_ERROR(validate(*model, file));
  return model;
}

/// Returns the network of moved pictures that a file holds, with the network of disparity that it names.
Result<Model> with_disparity(Model views, const Composition& of) {
  if (!reads_moved_pictures(views)) {
    return fail(ErrorCode::kFormat, of.location,
                "no network of views is named, and the network of this file does not read moved pictures; name one as "
                "`views`, and remove the tensors");
  }
  E2LF_ASSIGN_OR_RETURN(Model disparity,
                        read_part(of.disparity, of.location + ".disparity", of.guide.share_of_full_scale));
  if (!is_for_any_patterns(disparity)) {
    return fail(ErrorCode::kUnsupported, of.location + ".disparity", disparity.name,
                " was trained for its own patterns; name a network for any patterns");
  }
  views.open_guide = std::make_shared<const OpenGuide>(OpenGuide{of.guide, std::move(disparity)});
  views.parts = {of.disparity};
  return views;
}

}  // namespace

Result<Model> decode_model(std::span<const uint8_t> bytes, const std::string& file, const fs::path& folder) {
  E2LF_ASSIGN_OR_RETURN(Safetensors tensors, decode_safetensors(bytes, file));
  E2LF_ASSIGN_OR_RETURN(const Json json, header_of(tensors, file));
  if (!json.is_object() || !json.contains(kComposedOf)) {
    E2LF_ASSIGN_OR_RETURN(Model model, decode_own_weights(std::move(tensors), json, file, std::nullopt));
    if (!reads_moved_pictures(model)) return model;
    return fail(ErrorCode::kUnsupported, cat(file, ": ", kMetadataKey, ": $"),
                "a network of moved pictures needs one of disparity; name it as `", kComposedOf, ".disparity`");
  }
  E2LF_ASSIGN_OR_RETURN(const Composition composition, read_composition(json, file, folder));
  if (composition.has_own_network()) {
    E2LF_ASSIGN_OR_RETURN(Model picture, decode_own_weights(std::move(tensors), json, file, std::nullopt));
    return with_disparity(std::move(picture), composition);
  }
  if (tensors.tensors.empty()) return compose(composition, file);
  return fail(ErrorCode::kFormat, cat(file, ": ", tensors.tensors.begin()->first),
              "a model that is composed of two others holds no tensors of its own; remove it");
}

Result<Model> read_model(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return decode_model(bytes, path.string(), folder_of(path));
}

Result<StatedModel> read_stated_model(const fs::path& path) {
  const std::string file = path.string();
  E2LF_ASSIGN_OR_RETURN(Safetensors tensors, read_safetensors_header(path, kCodesTensor));
  E2LF_ASSIGN_OR_RETURN(Json json, header_of(tensors, file));
  StatedModel stated;
  stated.is_for_any_patterns =
      std::ranges::any_of(tensors.tensors, [](const auto& tensor) { return tensor.first.starts_with(kAnyPatterns); });
  if (json.is_object() && json.contains(kComposedOf)) {
    E2LF_ASSIGN_OR_RETURN(const Composition composition, read_composition(json, file, folder_of(path)));
    stated.guide = composition.guide;
    stated.is_for_any_patterns = composition.has_own_network();
    if (!composition.has_own_network()) {
      E2LF_ASSIGN_OR_RETURN(tensors, read_safetensors_header(composition.views, kCodesTensor));
      E2LF_ASSIGN_OR_RETURN(json, header_of_part(tensors, composition.views, composition.location));
      json["name"] = composition.name;
    }
  }
  E2LF_ASSIGN_OR_RETURN(stated.model, header_from_json(json, cat(file, ": ", kMetadataKey, ": $")));
  E2LF_RETURN_IF_ERROR(take_codes(tensors, file, stated.model));
  return stated;
}

Result<bool> is_video_model(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, read_safetensors(path));
  E2LF_ASSIGN_OR_RETURN(const Json json, header_of(tensors, path.string()));
  return json.is_object() && json.value("measurement", Json()) == kVoxelGrid;
}

namespace {

/// Returns how a file states the network of disparity that it names.
Json parts_to_json(const Guide& guide) {
  Json parts = {{"disparity", guide.disparity}};
  if (guide.weak_texture != Guide().weak_texture) parts["weak_texture"] = json_number(guide.weak_texture);
  if (guide.share_of_full_scale) parts["share_of_full_scale"] = json_number(*guide.share_of_full_scale);
  return parts;
}

}  // namespace

Result<void> write_model(const std::filesystem::path& path, const Model& model, WeightStorage storage) {
  // The network of disparity stays in its own file.
  const bool has_part = reads_moved_pictures(model) && model.open_guide;
  if (has_part) {
    Model own = model;
    own.open_guide = nullptr;
    E2LF_RETURN_IF_ERROR(validate(own, path.string()));
  } else {
    E2LF_RETURN_IF_ERROR(validate(model, path.string()));
  }
  Safetensors tensors;
  const auto store = [&](const std::string& name, const std::vector<size_t>& shape, const std::vector<float>& values) {
    tensors.tensors[name] =
        storage == WeightStorage::kBfloat16 ? make_bfloat16_tensor(shape, values) : make_npy<float>(shape, values);
  };
  const std::vector<WeightShape> shapes = weight_shapes(model.network);
  for (const WeightShape& tensor : shapes) store(tensor.name, tensor.shape, model.weights.at(tensor.name));
  for (const auto& [name, weights] : model.any_patterns) store(cat(kAnyPatterns, name), weights.shape, weights.values);
  Json header = header_to_json(model);
  if (has_part) header[kComposedOf] = parts_to_json(model.open_guide->guide);
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
  (void)reader.child(kShareOfFullScale);
  (void)reader.child(kComposedOf);
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
