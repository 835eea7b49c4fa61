// SPDX-License-Identifier: MIT
// Writes MATLAB files; declared in mat5.h.
#include "e2lf/base/contract.h"
#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/mat5.h"

namespace e2lf {
namespace {

constexpr size_t kTextBytes = 124, kWrittenTagBytes = 8;
constexpr uint64_t kMostBytes = (uint64_t{1} << 31) - 1024;
constexpr uint32_t kMatrixType = 14;

struct ClassStorage {
  MatStorage storage;
  size_t bytes_each;
};

ClassStorage own_storage(MatClass array_class) {
  switch (array_class) {
    case MatClass::kDouble:
      return {MatStorage::kDouble, 8};
    case MatClass::kSingle:
      return {MatStorage::kSingle, 4};
    case MatClass::kInt8:
      return {MatStorage::kInt8, 1};
    case MatClass::kUint8:
      return {MatStorage::kUint8, 1};
    case MatClass::kInt16:
      return {MatStorage::kInt16, 2};
    case MatClass::kUint16:
      return {MatStorage::kUint16, 2};
    case MatClass::kInt32:
      return {MatStorage::kInt32, 4};
    case MatClass::kUint32:
      return {MatStorage::kUint32, 4};
  }
  return {MatStorage::kDouble, 8};
}

void append_word(std::vector<uint8_t>& bytes, uint32_t word) {
  bytes.resize(bytes.size() + sizeof(word));
  store_le(bytes.data() + bytes.size() - sizeof(word), word);
}

/// Appends a tag, the data, and zeros up to a multiple of eight bytes.
void append_element(std::vector<uint8_t>& bytes, uint32_t type, std::span<const uint8_t> data) {
  append_word(bytes, type);
  append_word(bytes, static_cast<uint32_t>(data.size()));
  bytes.insert(bytes.end(), data.begin(), data.end());
  bytes.resize((bytes.size() + 7) / 8 * 8);
}

/// Returns the part of a matrix element that precedes its numbers: class, extents and name.
std::vector<uint8_t> matrix_head(const MatVariable& variable) {
  std::vector<uint8_t> flags, extents, head;
  append_word(flags, static_cast<uint32_t>(variable.array_class));
  append_word(flags, 0);
  for (const size_t extent : variable.extents) append_word(extents, static_cast<uint32_t>(extent));
  append_element(head, static_cast<uint32_t>(MatStorage::kUint32), flags);
  append_element(head, static_cast<uint32_t>(MatStorage::kInt32), extents);
  const auto* name = reinterpret_cast<const uint8_t*>(variable.name.data());
  append_element(head, static_cast<uint32_t>(MatStorage::kInt8), {name, variable.name.size()});
  return head;
}

}  // namespace

Result<std::vector<uint8_t>> encode_mat(std::span<const MatVariable> variables, const std::string& location) {
  std::string header = "MATLAB 5.0 MAT-file, written by e2lf";
  header.resize(kTextBytes, ' ');
  header += std::string("\x00\x01IM", 4);  // version 0x0100 and the byte order
  std::vector<uint8_t> file(header.begin(), header.end());
  for (const MatVariable& variable : variables) {
    const ClassStorage own = own_storage(variable.array_class);
    size_t count = 1;
    for (const size_t extent : variable.extents) count *= extent;
    E2LF_REQUIRE(variable.extents.size() >= 2, "an array of MATLAB has two axes at least");
    E2LF_REQUIRE(variable.data.size() == count * own.bytes_each, "the data must fill the array");
    if (variable.data.size() > kMostBytes) {
      return Error{ErrorCode::kUnsupported,
                   cat(variable.name, " takes ", variable.data.size() >> 20,
                       " MiB, and a MATLAB file of version 6 holds less than 2 GiB; write .h5 or .npz"),
                   location};
    }
    const std::vector<uint8_t> head = matrix_head(variable);
    const size_t padded = (variable.data.size() + 7) / 8 * 8;
    append_word(file, kMatrixType);
    append_word(file, static_cast<uint32_t>(head.size() + kWrittenTagBytes + padded));
    file.insert(file.end(), head.begin(), head.end());
    append_element(file, static_cast<uint32_t>(own.storage), variable.data);
  }
  return file;
}

}  // namespace e2lf
