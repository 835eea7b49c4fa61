// SPDX-License-Identifier: MIT
// Reads light fields in MATLAB files; declared in readers.h.
#include <cstring>
#include <vector>

#include "e2lf/base/text.h"
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
std::optional<SampleType> type_of_storage(uint32_t storage) {
  switch (static_cast<MatStorage>(storage)) {
    case MatStorage::kUint8:
      return SampleType::kUint8;
    case MatStorage::kUint16:
      return SampleType::kUint16;
    case MatStorage::kSingle:
      return SampleType::kFloat32;
    case MatStorage::kDouble:
      return SampleType::kFloat64;
    default:
      return std::nullopt;
  }
}

template <typename Stored>
std::vector<float> widen(std::span<const uint8_t> data) {
  std::vector<float> out(data.size() / sizeof(Stored));
  for (size_t i = 0; i < out.size(); ++i) {
    Stored value;
    std::memcpy(&value, data.data() + i * sizeof(Stored), sizeof(Stored));
    out[i] = static_cast<float>(value);
  }
  return out;
}

/// Converts samples of the other integer types to float. Returns none if the type is unknown.
std::vector<float> widened_samples(const MatArray& variable) {
  switch (static_cast<MatStorage>(variable.storage)) {
    case MatStorage::kInt8:
      return widen<int8_t>(variable.data);
    case MatStorage::kInt16:
      return widen<int16_t>(variable.data);
    case MatStorage::kInt32:
      return widen<int32_t>(variable.data);
    case MatStorage::kUint32:
      return widen<uint32_t>(variable.data);
    default:
      return {};
  }
}

}  // namespace

Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string() + ": LF";
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const MatArray variable, find_mat_array(file, "LF", options.max_bytes, location));
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
  array.type = type_of_storage(variable.storage).value_or(SampleType::kFloat32);
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, sample_bytes(array.type), options, location));

  std::vector<float> widened;
  array.bytes = variable.data;
  if (!type_of_storage(variable.storage)) {
    widened = widened_samples(variable);
    array.bytes = {reinterpret_cast<const uint8_t*>(widened.data()), widened.size() * sizeof(float)};
  }
  if (array.bytes.size() != array.shape.size() * sample_bytes(array.type)) {
    return Error{ErrorCode::kFormat, cat("the samples do not fill ", shape_text(extents), "; save the file again"),
                 location};
  }
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
