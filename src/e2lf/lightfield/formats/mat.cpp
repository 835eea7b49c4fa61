// SPDX-License-Identifier: MIT
#include <cstring>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

std::optional<SampleType> type_of_class(uint8_t array_class) {
  switch (static_cast<MatClass>(array_class)) {
    case MatClass::kUint8:
      return SampleType::kUint8;
    case MatClass::kUint16:
      return SampleType::kUint16;
    case MatClass::kSingle:
      return SampleType::kFloat32;
    case MatClass::kDouble:
      return SampleType::kFloat64;
    default:
      return std::nullopt;
  }
}

template <typename Stored>
std::vector<float> divide(std::span<const uint8_t> data, float divisor) {
  std::vector<float> out(data.size() / sizeof(Stored));
  for (size_t i = 0; i < out.size(); ++i) {
    Stored value;
    std::memcpy(&value, data.data() + i * sizeof(Stored), sizeof(Stored));
    out[i] = static_cast<float>(value) / divisor;
  }
  return out;
}

/// Samples that are not stored as their class's own type: MATLAB takes a smaller one where all values fit. Empty where
/// the type is none of these.
std::vector<float> from_smaller(const MatArray& variable, SampleType type) {
  const float divisor = type == SampleType::kUint8 ? 255.0F : type == SampleType::kUint16 ? 65535.0F : 1.0F;
  switch (static_cast<MatStorage>(variable.storage)) {
    case MatStorage::kUint8:
      return divide<uint8_t>(variable.data, divisor);
    case MatStorage::kInt8:
      return divide<int8_t>(variable.data, divisor);
    case MatStorage::kInt16:
      return divide<int16_t>(variable.data, divisor);
    case MatStorage::kUint16:
      return divide<uint16_t>(variable.data, divisor);
    case MatStorage::kInt32:
      return divide<int32_t>(variable.data, divisor);
    case MatStorage::kUint32:
      return divide<uint32_t>(variable.data, divisor);
    default:
      return {};
  }
}

MatStorage own_storage(SampleType type) {
  switch (type) {
    case SampleType::kUint8:
      return MatStorage::kUint8;
    case SampleType::kUint16:
      return MatStorage::kUint16;
    case SampleType::kFloat32:
      return MatStorage::kSingle;
    case SampleType::kFloat64:
      return MatStorage::kDouble;
  }
  return MatStorage::kDouble;
}

}  // namespace

Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string() + ": LF";
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const MatArray variable, find_mat_array(file, "LF", options.max_bytes, location));
  const auto type = type_of_class(variable.array_class);
  if (!type || variable.complex) {
    return Error{ErrorCode::kUnsupported, "not of class double, single, uint8 or uint16; convert it", location};
  }
  const std::vector<size_t>& extents = variable.extents;
  if (extents.size() != 4 && extents.size() != 5) {
    return Error{ErrorCode::kShape, cat("has extents ", shape_text(extents), "; store (U,V,H,W) or (U,V,H,W,C)"),
                 location};
  }
  StoredArray array;
  array.shape = {extents[0], extents[1], extents[2], extents[3], extents.size() == 5 ? extents[4] : 1};
  array.strides = matlab_uvhwc_strides(array.shape);
  array.type = *type;
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, sample_bytes(*type), options, location));

  std::vector<float> widened;
  array.bytes = variable.data;
  if (variable.storage != static_cast<uint32_t>(own_storage(*type))) {
    widened = from_smaller(variable, *type);
    array.type = SampleType::kFloat32;
    array.bytes = {reinterpret_cast<const uint8_t*>(widened.data()), widened.size() * sizeof(float)};
  }
  if (array.bytes.size() != array.shape.size() * sample_bytes(array.type)) {
    return Error{ErrorCode::kFormat, cat("the samples do not fill ", shape_text(extents), "; save the file again"),
                 location};
  }
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
