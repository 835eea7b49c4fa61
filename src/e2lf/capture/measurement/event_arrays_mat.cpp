// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/event_arrays_mat.h"

#include <algorithm>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"

namespace e2lf::capture {
namespace {

// Largest decompressed size of a variable.
constexpr uint64_t kMostMatBytes = uint64_t{2} << 30;

/// Transposes images [..., x, y] to [..., y, x]; `rows` and `columns` are those of the result.
std::vector<uint8_t> transposed(std::span<const uint8_t> bytes, size_t rows, size_t columns, size_t each) {
  std::vector<uint8_t> out(bytes.size());
  const size_t image = rows * columns * each;
  for (size_t begin = 0; image > 0 && begin < bytes.size(); begin += image) {
    for (size_t y = 0; y < rows; ++y) {
      for (size_t x = 0; x < columns; ++x) {
        std::copy_n(bytes.data() + begin + (x * rows + y) * each, each, out.data() + begin + (y * columns + x) * each);
      }
    }
  }
  return out;
}

/// Returns whether `count` is the product of the extents, which may overflow.
bool fills(size_t count, const std::vector<size_t>& extents) {
  for (const size_t extent : extents) {
    if (extent == 0 || count % extent != 0) return false;
    count /= extent;
  }
  return count == 1;
}

Result<NpyArray> to_numpy(const MatArray& array, const std::string& location) {
  const std::string type = numpy_code(array.storage);
  const size_t bytes = element_size(type);
  const bool is_numeric = array.array_class >= static_cast<uint8_t>(MatClass::kDouble) &&
                          array.array_class <= static_cast<uint8_t>(MatClass::kUint32);
  if (!is_numeric || array.complex || bytes == 0) {
    return Error{ErrorCode::kUnsupported,
                 "the array does not contain real numbers of 8 to 32 bits, single or double; convert it", location};
  }
  const std::vector<size_t>& extents = array.extents;
  if (extents.size() < 2 || array.data.size() % bytes != 0 || !fills(array.data.size() / bytes, extents)) {
    return Error{ErrorCode::kFormat, cat("the numbers do not fill ", shape_text(extents), "; save the file again"),
                 location};
  }
  NpyArray numbers;
  numbers.type = type;
  numbers.item_size = bytes;
  // The first axis is the fastest one in MATLAB and the slowest in numpy.
  numbers.shape.assign(extents.rbegin(), extents.rend());
  std::swap(numbers.shape[extents.size() - 1], numbers.shape[extents.size() - 2]);
  numbers.bytes = transposed(array.data, extents[0], extents[1], bytes);
  // MATLAB stores signed numbers without a sign if none is negative, so this does not indicate a lost sign.
  const auto array_class = static_cast<MatClass>(array.array_class);
  const bool is_unsigned =
      array_class == MatClass::kUint8 || array_class == MatClass::kUint16 || array_class == MatClass::kUint32;
  if (is_unsigned || numbers.type[0] != 'u') return numbers;
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, numbers.to_float(location));
  return make_npy<float>(numbers.shape, values);
}

}  // namespace

Result<NpzArrays> read_event_arrays_mat(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  NpzArrays arrays;
  for (const char* name : {"events", "codes", "camera", "views", "findings"}) {
    const std::string location = cat(path.string(), ": ", name);
    const auto found = find_mat_array(bytes, name, kMostMatBytes, location);
    if (!found && found.error().code == ErrorCode::kNotFound) continue;
    if (!found) return found.error();
    E2LF_ASSIGN_OR_RETURN(arrays[name], to_numpy(*found, location));
  }
  // MATLAB drops trailing axes of size 1, but keeps at least two.
  if (const auto events = arrays.find("events"); events != arrays.end() && events->second.shape.size() == 2) {
    std::vector<size_t>& shape = events->second.shape;
    constexpr size_t kFields = 5;  // of an event: t, x, y, p and perhaps another
    if (std::min(shape[0], shape[1]) <= kFields && std::max(shape[0], shape[1]) > 16) {
      return Error{ErrorCode::kShape,
                   cat("an array of shape ", shape_text(shape),
                       " is a list of events rather than an event image; write it as .csv with the columns t, x, y, p"),
                   cat(path.string(), ": events")};
    }
    shape.insert(shape.begin(), 1);
  }
  for (const char* name : {"camera", "views", "findings"}) {
    if (const auto text = arrays.find(name); text != arrays.end()) text->second.shape = {text->second.num_elements()};
  }
  return arrays;
}

}  // namespace e2lf::capture
