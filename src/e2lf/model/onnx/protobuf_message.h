// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace e2lf::model {

/// Writes a message in the wire format of protobuf (protobuf.dev/programming-guides/encoding), field after field in the
/// order of the calls. A field is identified by its number, 1 to 2^29 - 1.
class ProtobufMessage {
 public:
  /// Adds an int32, int64 or enumeration as a varint, which takes ten bytes for negative numbers.
  void add_integer(uint32_t field, int64_t value);

  /// Adds a string or bytes, preceded by their length.
  void add_bytes(uint32_t field, std::string_view value);

  /// Adds a nested message.
  void add_message(uint32_t field, const ProtobufMessage& message) { add_bytes(field, message.bytes_); }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void add_key(uint32_t field, uint32_t wire_type);
  void add_varint(uint64_t value);
  std::string bytes_;
};

}  // namespace e2lf::model
