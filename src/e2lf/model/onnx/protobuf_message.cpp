// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/protobuf_message.h"

#include "e2lf/base/contract.h"

namespace e2lf::model {
namespace {

enum WireType : uint32_t { kVarint = 0, kLengthDelimited = 2 };
constexpr uint32_t kMostFields = (uint32_t{1} << 29) - 1;

}  // namespace

void ProtobufMessage::add_varint(uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<char>((value & 0x7F) | 0x80));
  bytes_.push_back(static_cast<char>(value));
}

void ProtobufMessage::add_key(uint32_t field, uint32_t wire_type) {
  E2LF_REQUIRE(field >= 1 && field <= kMostFields, "a field's number is in 1 to 2^29 - 1");
  add_varint(uint64_t{field} << 3 | wire_type);
}

void ProtobufMessage::add_integer(uint32_t field, int64_t value) {
  add_key(field, kVarint);
  add_varint(static_cast<uint64_t>(value));
}

void ProtobufMessage::add_bytes(uint32_t field, std::string_view value) {
  add_key(field, kLengthDelimited);
  add_varint(value.size());
  bytes_ += value;
}

}  // namespace e2lf::model
