// SPDX-License-Identifier: MIT
// Imports the paper's released weights; declared in model.h.
#include "e2lf/base/text.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
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
    return Error{ErrorCode::kShape,
                 cat("patterns of shape ", shape_text(tensor->shape), ", the release has ",
                     shape_text({kPatterns, kViews}), "; give the released file"),
                 location};
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
