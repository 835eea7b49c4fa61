// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/base/result.h"
#include "e2lf/model/onnx/onnx_graph.h"

namespace e2lf::model {
namespace {

std::string hex(const ProtobufMessage& message) {
  std::string text;
  for (const char byte : message.bytes()) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[static_cast<uint8_t>(byte) >> 4];
    text += kDigits[static_cast<uint8_t>(byte) & 15];
  }
  return text;
}

TEST(ProtobufMessage, WritesTheExamplesOfTheSpecification) {
  ProtobufMessage integer;
  integer.add_integer(1, 150);
  EXPECT_EQ(hex(integer), "089601");

  ProtobufMessage text;
  text.add_bytes(2, "testing");
  EXPECT_EQ(hex(text), "120774657374696e67");

  ProtobufMessage outer;
  outer.add_message(3, integer);
  EXPECT_EQ(hex(outer), "1a03089601");
}

TEST(ProtobufMessage, WritesTheEndsOfTheRangeOfIntegers) {
  ProtobufMessage message;
  message.add_integer(1, 0);
  message.add_integer(1, 127);
  message.add_integer(1, 128);
  message.add_integer(1, -2);
  message.add_integer(1, std::numeric_limits<int64_t>::max());
  EXPECT_EQ(hex(message),
            "0800"
            "087f"
            "088001"
            "08feffffffffffffffff01"
            "08ffffffffffffffff7f");
}

TEST(ProtobufMessage, WritesKeysOfSeveralBytes) {
  ProtobufMessage message;
  message.add_integer(20, 7);
  message.add_bytes((uint32_t{1} << 29) - 1, "");
  EXPECT_EQ(hex(message), "a00107faffffff0f00");
}

TEST(ProtobufMessage, RefusesFieldNumbersThatDoNotExist) {
  ProtobufMessage message;
  EXPECT_THROW(message.add_integer(0, 1), ContractError);
  EXPECT_THROW(message.add_integer(uint32_t{1} << 29, 1), ContractError);
}

}  // namespace
}  // namespace e2lf::model
