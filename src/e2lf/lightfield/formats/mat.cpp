// SPDX-License-Identifier: MIT
// Reads light fields in MATLAB files; declared in readers.h.
#include <optional>
#include <string_view>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

/// Returns the number that is white in an array of this class, or 0 if the class does not determine it.
float white_of_class(const MatArray& variable) {
  if (variable.logical) return 1.0F;
  switch (static_cast<MatClass>(variable.array_class)) {
    case MatClass::kUint8:
      return 255.0F;
    case MatClass::kUint16:
      return 65535.0F;
    case MatClass::kSingle:
    case MatClass::kDouble:
      return 1.0F;
    default:
      return 0.0F;
  }
}

/// Returns the stored type of the samples if from_stored() can read it.
std::optional<SampleType> type_of_code(std::string_view code) {
  if (code == "u1") return SampleType::kUint8;
  if (code == "u2") return SampleType::kUint16;
  if (code == "f4") return SampleType::kFloat32;
  return code == "f8" ? std::optional(SampleType::kFloat64) : std::nullopt;
}

}  // namespace

Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string() + ": LF";
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, read_file(path));
  const Result<MatArray> found = find_mat_array(file, "LF", options.max_bytes, location);
  if (!found && found.error().code == ErrorCode::kNotFound) {
    E2LF_ASSIGN_OR_RETURN(const std::vector<std::string> names, mat_variables(path));
    return Error{ErrorCode::kNotFound,
                 cat("the file contains no light field LF, but ", names.empty() ? "no variable" : join(names),
                     "; save a light field under that name, and events as .csv with the columns t, x, y, p"),
                 path.string()};
  }
  if (!found) return found.error();
  const MatArray& variable = *found;
  const bool is_number = variable.array_class >= static_cast<uint8_t>(MatClass::kDouble) &&
                         variable.array_class <= static_cast<uint8_t>(MatClass::kUint32);
  if (!is_number || variable.complex) {
    return Error{ErrorCode::kUnsupported,
                 "not of class double, single, logical or integers of 8 to 32 bits, or complex; convert it", location};
  }
  const float white = white_of_class(variable);
  if (white == 0.0F && options.white == 0.0F) {
    return Error{ErrorCode::kUnsupported,
                 "integers of this class do not determine which value is white; give it, e.g. 255", location,
                 Setting::kWhite};
  }
  const std::vector<size_t>& extents = variable.extents;
  if (extents.size() != 4 && extents.size() != 5) {
    return Error{ErrorCode::kShape, cat("has extents ", shape_text(extents), "; store (U,V,H,W) or (U,V,H,W,C)"),
                 location};
  }
  StoredArray array;
  array.shape = {extents[0], extents[1], extents[2], extents[3], extents.size() == 5 ? extents[4] : 1};
  array.strides = matlab_uvhwc_strides(array.shape);
  array.white = white;
  // MATLAB stores numbers as a smaller type than that of their class if all of them fit.
  const std::string code = numpy_code(variable.storage);
  const auto type = type_of_code(code);
  array.type = type.value_or(SampleType::kFloat32);
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, sample_bytes(array.type), options, location));

  std::vector<float> widened;
  array.bytes = variable.data;
  if (!type) {
    E2LF_ASSIGN_OR_RETURN(widened, elements_to_float(code, variable.data, location));
    array.bytes = {reinterpret_cast<const uint8_t*>(widened.data()), widened.size() * sizeof(float)};
  }
  if (array.bytes.size() != array.shape.size() * sample_bytes(array.type)) {
    return Error{ErrorCode::kFormat, cat("the samples do not fill ", shape_text(extents), "; save the file again"),
                 location};
  }
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
