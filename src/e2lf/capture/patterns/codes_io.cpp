// SPDX-License-Identifier: MIT
// Apart from codes.cpp, because a build of training alone has no .npy and .npz files.
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {

namespace {

constexpr const char* kArrayName = "codes";

Error unknown_extension(const std::filesystem::path& path) {
  return fail(ErrorCode::kUnsupported, path, "aperture patterns are .json, .npy or .npz files, not \"",
              path.extension().string(), "\"");
}

}  // namespace

NpyArray codes_to_npy(const Codes& codes) {
  return make_npy<float>({codes.num_patterns, codes.views_y, codes.views_x}, codes.values);
}

Result<Codes> codes_from_npy(const NpyArray& array, const std::string& location) {
  if (array.shape.size() != 3) {
    return fail(ErrorCode::kShape, location, "patterns have the shape [N, view_y, view_x], not ",
                shape_text(array.shape), "; reshape the array");
  }
  constexpr size_t kLeastGrid = 5;  // as many patterns of a smaller grid are plausible
  if (array.shape[0] == array.shape[1] && array.shape[1] >= kLeastGrid && array.shape[2] != array.shape[1]) {
    return fail(ErrorCode::kShape, location, "patterns have the shape [N, view_y, view_x], and ",
                shape_text(array.shape), " is probably [view_y, view_x, N]; move the last axis to the front");
  }
  Codes codes(array.shape[0], array.shape[1], array.shape[2]);
  E2LF_ASSIGN_OR_RETURN(codes.values, array.to_float(location));
  E2LF_RETURN_IF_ERROR(validate(codes, location));
  return codes;
}

Result<Codes> read_codes(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".json") {
    E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
    return codes_from_json(json, path.string());
  }
  if (extension == ".npy") {
    E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
    return codes_from_npy(array, path.string());
  }
  if (extension == ".npz") {
    E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, read_npz(path));
    const auto found = arrays.find(kArrayName);
    if (found == arrays.end()) {
      return fail(ErrorCode::kNotFound, path, "there is no array \"codes\"; add it, or give the patterns as .json");
    }
    return codes_from_npy(found->second, cat(path.string(), ": ", kArrayName));
  }
  return unknown_extension(path);
}

Result<void> write_codes(const std::filesystem::path& path, const Codes& codes) {
  const std::string extension = path.extension().string();
  if (extension == ".json") return write_file(path, json_text(codes_to_json(codes)));
  if (extension == ".npy") return write_npy(path, codes_to_npy(codes));
  if (extension == ".npz") return write_npz(path, {{kArrayName, codes_to_npy(codes)}});
  return unknown_extension(path);
}

}  // namespace e2lf::capture
