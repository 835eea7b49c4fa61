// SPDX-License-Identifier: MIT
// Reads and writes model files; declared in model.h.
#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
namespace {

constexpr const char* kCodesTensor = "aperture.codes";

Result<const Tensor*> find_float(const Safetensors& tensors, const std::string& name, const std::string& file) {
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, tensors.find(name, file));
  if (tensor->type == "F32" || tensor->type == "BF16") return tensor;
  return fail(ErrorCode::kUnsupported, cat(file, ": ", name), "the element type ", tensor->type,
              " is not supported; save it as F32 or BF16");
}

Result<capture::Codes> codes_from_tensor(const Model& model, const Safetensors& tensors, const std::string& file) {
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find_float(tensors, kCodesTensor, file));
  const std::vector<size_t> expected = {model.num_patterns, model.views_y, model.views_x};
  const std::string location = cat(file, ": ", kCodesTensor);
  if (tensor->shape != expected) {
    return fail(ErrorCode::kShape, location, "the codes have shape ", shape_text(tensor->shape),
                ", but the model requires ", shape_text(expected), "; store the patterns of this model");
  }
  capture::Codes codes(model.num_patterns, model.views_y, model.views_x);
  E2LF_ASSIGN_OR_RETURN(codes.values, tensor->to_float(location));
  return codes;
}

}  // namespace

Result<Json> header_of(const Safetensors& tensors, const std::string& file) {
  const auto metadata = tensors.metadata.find(kMetadataKey);
  if (metadata == tensors.metadata.end()) {
    return Error{
        ErrorCode::kFormat,
        "not an e2lf model (its metadata has no \"e2lf\"); `e2lf model import` creates one from the weights of "
        "the paper or of a published network",
        file};
  }
  return parse_json(metadata->second, cat(file, ": ", kMetadataKey));
}

Result<Weights> weights_from_tensors(const Network& network, const Safetensors& tensors, const std::string& file) {
  Weights weights;
  for (const WeightShape& wanted : weight_shapes(network)) {
    E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find_float(tensors, wanted.name, file));
    const std::string location = cat(file, ": ", wanted.name);
    if (tensor->shape != wanted.shape) {
      return fail(ErrorCode::kShape, location, "the weights have shape ", shape_text(tensor->shape),
                  ", but the network requires ", shape_text(wanted.shape), "; store the weights of this network");
    }
    E2LF_ASSIGN_OR_RETURN(weights[wanted.name], tensor->to_float(location));
  }
  for (const auto& entry : tensors.tensors) {
    if (entry.first == kCodesTensor || weights.contains(entry.first)) continue;
    return fail(ErrorCode::kFormat, cat(file, ": ", entry.first),
                "the tensor belongs to no layer of the network; remove it or describe its layer");
  }
  return weights;
}

Result<Model> decode_model(std::span<const uint8_t> bytes, const std::string& file) {
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, decode_safetensors(bytes, file));
  E2LF_ASSIGN_OR_RETURN(const Json json, header_of(tensors, file));
  E2LF_ASSIGN_OR_RETURN(Model model, header_from_json(json, cat(file, ": ", kMetadataKey, ": $")));
  E2LF_ASSIGN_OR_RETURN(model.weights, weights_from_tensors(model.network, tensors, file));
  if (tensors.tensors.contains(kCodesTensor)) {
    E2LF_ASSIGN_OR_RETURN(model.codes, codes_from_tensor(model, tensors, file));
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
  tensors.metadata[kMetadataKey] = json_line(header_to_json(model));
  for (const WeightShape& tensor : weight_shapes(model.network)) {
    const std::vector<float>& values = model.weights.at(tensor.name);
    tensors.tensors[tensor.name] = storage == WeightStorage::kBfloat16 ? make_bfloat16_tensor(tensor.shape, values)
                                                                       : make_tensor(tensor.shape, values);
  }
  if (model.codes) {
    tensors.tensors[kCodesTensor] =
        make_tensor({model.codes->num_patterns, model.codes->views_y, model.codes->views_x}, model.codes->values);
  }
  return write_safetensors(path, tensors);
}

namespace {

constexpr size_t kPatterns = 4;
constexpr size_t kViews = 64;  // 8 rows of 8, numbered row by row
constexpr const char* kReleaseCodes = "mask_4x64";

Result<capture::Codes> import_codes(const std::filesystem::path& path) {
  const std::string file = path.string();
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, read_safetensors(path));
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, tensors.find(kReleaseCodes, file));
  const std::string location = cat(file, ": ", kReleaseCodes);
  if (tensor->shape != std::vector<size_t>{kPatterns, kViews}) {
    return fail(ErrorCode::kShape, location, "the patterns have shape ", shape_text(tensor->shape),
                ", but the release has ", shape_text({kPatterns, kViews}), "; give the released file");
  }
  capture::Codes codes(kPatterns, 8, 8);
  E2LF_ASSIGN_OR_RETURN(codes.values, tensor->to_float(location));
  return codes;
}

}  // namespace

Result<Model> import_release(const std::filesystem::path& folder) {
  const auto network_path = folder / "RecNet.safetensors";
  Model model;
  model.name = "coded-e2lf-release";
  model.num_patterns = kPatterns;
  model.input = {{InputKind::kCounts, 1.0F / 8.0F}};
  model.network = recnet(kPatterns - 1, kViews);
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, read_safetensors(network_path));
  E2LF_ASSIGN_OR_RETURN(model.weights, weights_from_tensors(model.network, tensors, network_path.string()));
  E2LF_ASSIGN_OR_RETURN(model.codes, import_codes(folder / "AcqNet.safetensors"));
  model.provenance = {
      {"source", "released weights of the Coded-E2LF paper (Baseline+BF+RA, N = 4)"},
      {"licence", "MIT, see the release"},
      {"imported_from", {"RecNet.safetensors", "AcqNet.safetensors"}},
  };
  E2LF_RETURN_IF_ERROR(validate(model, folder.string()));
  return model;
}

}  // namespace e2lf::model
