// SPDX-License-Identifier: MIT
#include "e2lf/files/npy.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <numeric>
#include <type_traits>

#include "e2lf/base/text.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy_header.h"

namespace e2lf {
namespace {

Error records_error(const std::string& name) {
  return {ErrorCode::kUnsupported, "an array of records where plain numbers are expected; store one field", name};
}

void reverse_big_endian(const NpyHeader& header, std::vector<uint8_t>& bytes) {
  for (size_t item = 0; item < bytes.size(); item += header.array.item_size) {
    for (const NpyHeader::Number& number : header.big_endian) {
      const auto begin = bytes.begin() + static_cast<ptrdiff_t>(item + number.offset);
      std::reverse(begin, begin + static_cast<ptrdiff_t>(number.size));
    }
  }
}

/// Reorders column-major items (the first index runs fastest) to row-major order.
std::vector<uint8_t> fortran_to_c(const NpyArray& array, const std::vector<uint8_t>& bytes) {
  std::vector<uint8_t> ordered(bytes.size());
  std::vector<size_t> index(array.shape.size(), 0);
  std::vector<size_t> strides(array.shape.size());
  size_t stride = array.item_size;
  for (size_t axis = 0; axis < strides.size(); ++axis) {
    strides[axis] = stride;
    stride *= array.shape[axis];
  }
  size_t source = 0;
  for (size_t target = 0; target < ordered.size(); target += array.item_size) {
    std::memcpy(ordered.data() + target, bytes.data() + source, array.item_size);
    // Advance the row-major index; the last axis runs fastest.
    for (size_t axis = index.size(); axis-- > 0;) {
      source += strides[axis];
      if (++index[axis] < array.shape[axis]) break;
      source -= strides[axis] * index[axis];
      index[axis] = 0;
    }
  }
  return ordered;
}

template <typename T>
std::string npy_code() {
  const char kind = std::is_floating_point_v<T> ? 'f' : std::is_signed_v<T> ? 'i' : 'u';
  return cat(kind, sizeof(T));
}

}  // namespace

size_t NpyArray::num_elements() const {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

Result<std::vector<float>> NpyArray::to_float(const std::string& name) const {
  if (!fields.empty()) return records_error(name);
  return elements_to_float(type, bytes, name);
}

Result<std::vector<int32_t>> NpyArray::to_int32(const std::string& name) const {
  if (!fields.empty()) return records_error(name);
  return elements_to_int32(type, bytes, name);
}

template <typename T>
NpyArray make_npy(std::vector<size_t> shape, std::span<const T> values) {
  NpyArray array;
  array.type = npy_code<T>();
  array.item_size = sizeof(T);
  array.shape = std::move(shape);
  E2LF_REQUIRE(array.num_elements() == values.size(), "the shape does not fit the values");
  const auto bytes = std::as_bytes(values);
  array.bytes.resize(bytes.size());
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::byte*>(array.bytes.data()));
  return array;
}

template NpyArray make_npy(std::vector<size_t>, std::span<const float>);
template NpyArray make_npy(std::vector<size_t>, std::span<const double>);
template NpyArray make_npy(std::vector<size_t>, std::span<const uint8_t>);
template NpyArray make_npy(std::vector<size_t>, std::span<const int8_t>);
template NpyArray make_npy(std::vector<size_t>, std::span<const int16_t>);
template NpyArray make_npy(std::vector<size_t>, std::span<const uint16_t>);
template NpyArray make_npy(std::vector<size_t>, std::span<const int32_t>);
template NpyArray make_npy(std::vector<size_t>, std::span<const int64_t>);

Result<NpyArray> decode_npy(std::span<const uint8_t> bytes, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(bytes, name));
  const std::span<const uint8_t> data = bytes.subspan(header.data_offset);
  if (data.size() != header.data_size) {
    const bool truncated = data.size() < header.data_size;
    return Error{truncated ? ErrorCode::kTruncated : ErrorCode::kFormat,
                 cat("the header of shape ", shape_text(header.array.shape), " needs ", header.data_size,
                     " bytes of data, the file has ", data.size(), "; ",
                     truncated ? "copy it again" : "store one array in each file"),
                 name};
  }
  header.array.bytes.assign(data.begin(), data.end());
  if (!header.big_endian.empty()) reverse_big_endian(header, header.array.bytes);
  if (header.fortran_order) header.array.bytes = fortran_to_c(header.array, header.array.bytes);
  return std::move(header.array);
}

std::vector<uint8_t> encode_npy(const NpyArray& array) {
  E2LF_REQUIRE(array.bytes.size() == array.num_elements() * array.item_size, "the shape does not fit the bytes");
  std::vector<uint8_t> bytes = npy_header_bytes(array);
  bytes.insert(bytes.end(), array.bytes.begin(), array.bytes.end());
  return bytes;
}

Result<NpyArray> read_npy(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return decode_npy(bytes, path.string());
}

Result<NpyArray> peek_npy(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto head, read_head(path, kNpyHeadBytes));
  auto header = parse_npy_header(head, path.string());
  if (header) return std::move(header->array);
  // A header longer than that is valid, if rare.
  if (header.error().code != ErrorCode::kTruncated || head.size() < kNpyHeadBytes) return header.error();
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(NpyHeader longer, parse_npy_header(bytes, path.string()));
  return std::move(longer.array);
}

Result<void> write_npy(const std::filesystem::path& path, const NpyArray& array) {
  return write_file(path, encode_npy(array));
}

}  // namespace e2lf
