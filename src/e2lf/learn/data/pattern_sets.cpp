// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/pattern_sets.h"

#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {

Result<capture::Codes> read_pattern_set(const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const std::filesystem::path path, find_file_or_bundled(kBundledCodes, name));
  std::optional<capture::Codes> codes;
  if (path.extension() == ".safetensors") {
    E2LF_ASSIGN_OR_RETURN(const auto model, model::read_model(path));
    codes = model.codes;
  } else {
    E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
    E2LF_ASSIGN_OR_RETURN(codes, capture::codes_from_json(json, path.string()));
  }
  if (!codes || codes->views_y != 8 || codes->views_x != 8) {
    return fail(ErrorCode::kShape, path, "the file does not contain patterns of 8x8 cells; choose another file");
  }
  return *codes;
}

}  // namespace e2lf::learn
