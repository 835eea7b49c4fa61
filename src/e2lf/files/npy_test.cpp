// SPDX-License-Identifier: MIT
#include "e2lf/files/npy.h"

#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<uint8_t> npy_file(const std::string& dictionary, const std::vector<uint8_t>& data, uint8_t version = 1) {
  std::vector<uint8_t> bytes = {0x93, 'N', 'U', 'M', 'P', 'Y', version, 0};
  for (size_t i = 0; i < (version == 1 ? 2 : 4); ++i)
    bytes.push_back(static_cast<uint8_t>(dictionary.size() >> (8 * i)));
  bytes.insert(bytes.end(), dictionary.begin(), dictionary.end());
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

std::string header(const std::string& descr, const std::string& shape, const std::string& fortran = "False") {
  return "{'descr': " + descr + ", 'fortran_order': " + fortran + ", 'shape': " + shape + ", }\n";
}

ErrorCode npy_error(const std::vector<uint8_t>& bytes) {
  const auto array = decode_npy(bytes, "test.npy");
  EXPECT_FALSE(array.ok());
  return array.ok() ? ErrorCode::kInternal : array.error().code;
}

template <typename T>
void expect_round_trip(const std::string& code) {
  const std::vector<T> values = {
      T(0), T(1), T(2), std::numeric_limits<T>::max(), T(100), std::numeric_limits<T>::min()};
  const NpyArray array = make_npy<T>({2, 3}, values);
  EXPECT_EQ(array.type, code);
  const auto read = decode_npy(encode_npy(array), "x");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->type, code);
  EXPECT_EQ(read->shape, (std::vector<size_t>{2, 3}));
  EXPECT_EQ(read->bytes, array.bytes);
  const auto floats = read->to_float("x");
  ASSERT_TRUE(floats.ok());
  for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ((*floats)[i], static_cast<float>(values[i]));
}

TEST(Npy, RoundTripsEveryTypeItMakes) {
  expect_round_trip<float>("f4");
  expect_round_trip<double>("f8");
  expect_round_trip<int8_t>("i1");
  expect_round_trip<uint8_t>("u1");
  expect_round_trip<int16_t>("i2");
  expect_round_trip<uint16_t>("u2");
  expect_round_trip<int32_t>("i4");
  expect_round_trip<int64_t>("i8");
}

TEST(Npy, WritesTheHeaderThatNumpyWrites) {
  const auto bytes = encode_npy(make_npy<uint8_t>({3}, std::vector<uint8_t>{7, 8, 9}));
  const std::string text = "{'descr': '|u1', 'fortran_order': False, 'shape': (3,), }";
  ASSERT_EQ(bytes.size(), 128U + 3U);
  EXPECT_EQ(bytes[6], 1);
  EXPECT_EQ(bytes[8], 118);
  EXPECT_EQ(std::string(bytes.begin() + 10, bytes.begin() + 10 + static_cast<ptrdiff_t>(text.size())), text);
  EXPECT_EQ(bytes[127], '\n');
  EXPECT_EQ(bytes[128], 7);
}

TEST(Npy, RoundTripsScalarsAndEmptyArrays) {
  const auto scalar = decode_npy(encode_npy(make_npy<float>({}, std::vector<float>{2.5F})), "x");
  ASSERT_TRUE(scalar.ok());
  EXPECT_TRUE(scalar->shape.empty());
  EXPECT_THAT(*scalar->to_float("x"), ElementsAre(2.5F));
  const auto empty = decode_npy(encode_npy(make_npy<float>({0, 720}, std::vector<float>{})), "x");
  ASSERT_TRUE(empty.ok());
  EXPECT_EQ(empty->shape, (std::vector<size_t>{0, 720}));
  EXPECT_TRUE(empty->to_float("x")->empty());
}

TEST(Npy, TurnsFortranOrderIntoC) {
  // The array [[0, 1, 2], [3, 4, 5]] stored column by column.
  const auto array = decode_npy(npy_file(header("'|i1'", "(2, 3)", "True"), {0, 3, 1, 4, 2, 5}), "x");
  ASSERT_TRUE(array.ok());
  EXPECT_THAT(array->bytes, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(Npy, TurnsFortranOrderOfThreeAxesAndWideElementsIntoC) {
  // Element [i, j, k] = 100 i + 10 j + k in column-major order: i runs fastest.
  std::vector<uint8_t> data;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 2; ++i) data.insert(data.end(), {static_cast<uint8_t>(100 * i + 10 * j + k), 0});
    }
  }
  const auto array = decode_npy(npy_file(header("'<i2'", "(2, 3, 4)", "True"), data), "x");
  ASSERT_TRUE(array.ok());
  const auto values = *array->to_float("x");
  for (int n = 0; n < 24; ++n) {
    EXPECT_EQ(static_cast<int>(values[static_cast<size_t>(n)]), 100 * (n / 12) + 10 * (n / 4 % 3) + n % 4);
  }
}

TEST(Npy, TurnsBigEndianIntoLittle) {
  const auto array = decode_npy(npy_file(header("'>i2'", "(2,)"), {0x01, 0x02, 0xFF, 0xFE}), "x");
  ASSERT_TRUE(array.ok());
  EXPECT_EQ(array->type, "i2");
  EXPECT_THAT(*array->to_float("x"), ElementsAre(0x0102, -2));
}

TEST(Npy, ReadsStructuredArraysWithPaddingAndMixedByteOrder) {
  const std::string descr = "[('x', '<u2'), ('', '|V2'), ('t', '>i4')]";
  const auto array = decode_npy(npy_file(header(descr, "(2,)"), {1, 2, 9, 9, 0, 0, 0, 5, 3, 4, 9, 9, 0, 0, 1, 0}), "x");
  ASSERT_TRUE(array.ok());
  EXPECT_EQ(array->item_size, 8U);
  ASSERT_EQ(array->fields.size(), 2U);
  EXPECT_EQ(array->fields[1].name, "t");
  EXPECT_EQ(array->fields[1].type, "i4");
  EXPECT_EQ(array->fields[1].offset, 4U);
  EXPECT_THAT(array->bytes, ElementsAre(1, 2, 9, 9, 5, 0, 0, 0, 3, 4, 9, 9, 0, 1, 0, 0));
  EXPECT_EQ(array->to_float("x").error().code, ErrorCode::kUnsupported);
}

TEST(Npy, RoundTripsStructuredArrays) {
  NpyArray events;
  events.fields = {{"x", "u2", 0}, {"y", "u2", 2}, {"p", "i2", 4}, {"t", "i8", 8}};
  events.item_size = 16;
  events.shape = {2};
  for (uint8_t i = 0; i < 32; ++i) events.bytes.push_back(i);
  const auto read = decode_npy(encode_npy(events), "x");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->item_size, 16U);
  ASSERT_EQ(read->fields.size(), 4U);
  EXPECT_EQ(read->fields[3].offset, 8U);
  EXPECT_EQ(read->bytes, events.bytes);
}

TEST(Npy, ReadsVersionsTwoAndThreeAndRefusesOthers) {
  const std::string text = header("'<f4'", "(1,)");
  for (const uint8_t version : {2, 3}) {
    const auto array = decode_npy(npy_file(text, {0, 0, 0x80, 0x3F}, version), "x");
    ASSERT_TRUE(array.ok());
    EXPECT_THAT(*array->to_float("x"), ElementsAre(1.0F));
  }
  EXPECT_EQ(npy_error(npy_file(text, {0, 0, 0x80, 0x3F}, 4)), ErrorCode::kUnsupported);
}

TEST(Npy, ReportsEveryTruncation) {
  EXPECT_EQ(npy_error({}), ErrorCode::kTruncated);
  const auto whole = encode_npy(make_npy<int16_t>({4}, std::vector<int16_t>{1, 2, 3, 4}));
  for (size_t size = 0; size < whole.size(); ++size) {
    const auto array = decode_npy(std::span(whole).first(size), "cut.npy");
    ASSERT_FALSE(array.ok()) << size;
    EXPECT_EQ(array.error().code, ErrorCode::kTruncated) << size;
    EXPECT_THAT(array.error().location, HasSubstr("cut.npy"));
  }
}

TEST(Npy, RefusesAHeaderLargerThanTheFileWithoutAllocating) {
  EXPECT_EQ(npy_error(npy_file(header("'<f4'", "(1000000000000,)"), {0, 0, 0, 0})), ErrorCode::kTruncated);
  EXPECT_EQ(npy_error(npy_file(header("'<f4'", "(4294967296, 4294967296)"), {0})), ErrorCode::kFormat);
  EXPECT_EQ(npy_error(npy_file(header("'<f4'", "(0, 4294967296, 4294967296)"), {})), ErrorCode::kFormat);
  EXPECT_EQ(npy_error({0x93, 'N', 'U', 'M', 'P', 'Y', 2, 0, 0xFF, 0xFF, 0xFF, 0xFF, '{'}), ErrorCode::kTruncated);
}

TEST(Npy, RefusesBytesAfterTheArray) {
  EXPECT_EQ(npy_error(npy_file(header("'|u1'", "(2,)"), {1, 2, 3})), ErrorCode::kFormat);
}

TEST(Npy, RefusesDamagedHeaders) {
  const std::vector<std::string> damaged = {"",
                                            "[]",
                                            "{",
                                            "{'descr': '|u1'}",
                                            "{'fortran_order': False, 'shape': (1,), }",
                                            header("'|u1'", "(-1,)"),
                                            header("'|u1'", "(1"),
                                            header("'|u1'", "1"),
                                            header("|u1", "(1,)"),
                                            header("'|u1'", "(1,)", "Maybe"),
                                            header("'|u1'", "(1,)") + "more",
                                            header("[]", "(1,)"),
                                            "{'descr': '|u1', 'fortran_order': False, 'shape': (1,), 'colour': 1}",
                                            header("[('x', '<u2'), 3]", "(1,)"),
                                            header("[('a', '|V18446744073709551615'), ('b', '<u2')]", "(1,)")};
  for (const std::string& text : damaged) EXPECT_EQ(npy_error(npy_file(text, {0})), ErrorCode::kFormat) << text;
  EXPECT_EQ(npy_error({'P', 'K', 3, 4, 0, 0, 0, 0, 0, 0, 0, 0}), ErrorCode::kFormat);
  const std::string deep = std::string(400'000, '[') + std::string(400'000, ']');
  EXPECT_EQ(npy_error(npy_file(header(deep, "(1,)"), {0}, 2)), ErrorCode::kFormat);
}

TEST(Npy, RefusesElementsThatAreNotNumbers) {
  for (const char* descr : {"'<c8'", "'|S3'", "'<U4'", "'|O'", "'|V4'", "'<f16'", "'<i3'", "[('x', '<u2', (3,))]",
                            "[('x', [('y', '<u2')])]", "[('x', '|S2')]"}) {
    EXPECT_EQ(npy_error(npy_file(header(descr, "(1,)"), std::vector<uint8_t>(16))), ErrorCode::kUnsupported) << descr;
  }
}

TEST(Npy, ConvertsHalfPrecisionAndBoolean) {
  // 1, -2, the smallest subnormal, infinity, NaN.
  const auto half =
      decode_npy(npy_file(header("'<f2'", "(5,)"), {0x00, 0x3C, 0x00, 0xC0, 0x01, 0x00, 0x00, 0x7C, 0x01, 0x7E}), "x");
  const auto values = *half->to_float("x");
  EXPECT_EQ(values[0], 1.0F);
  EXPECT_EQ(values[1], -2.0F);
  EXPECT_EQ(values[2], 0x1p-24F);
  EXPECT_TRUE(std::isinf(values[3]));
  EXPECT_TRUE(std::isnan(values[4]));
  const auto flags = decode_npy(npy_file(header("'|b1'", "(3,)"), {0, 1, 255}), "x");
  EXPECT_THAT(*flags->to_float("x"), ElementsAre(0.0F, 1.0F, 1.0F));
}

TEST(Npy, MakingAnArrayOfAnotherShapeBreaksTheContract) {
  EXPECT_THROW((void)make_npy<float>({3}, std::vector<float>{1.0F}), ContractError);
}

TEST(Npy, FilesRoundTripAndErrorsNameTheFile) {
  const TestFolder folder;
  const NpyArray array = make_npy<int32_t>({2, 1}, std::vector<int32_t>{-5, 6});
  ASSERT_TRUE(write_npy(folder / "a.npy", array).ok());
  const auto read = read_npy(folder / "a.npy");
  ASSERT_TRUE(read.ok());
  EXPECT_THAT(*read->to_float("x"), ElementsAre(-5, 6));
  EXPECT_EQ(read_npy(folder / "none.npy").error().code, ErrorCode::kNotFound);
  EXPECT_THAT(read_npy(folder / "none.npy").error().location, HasSubstr("none.npy"));
}

TEST(Npy, ReadsTheReleasedCapture) {
  E2LF_REQUIRE_DATA("official/Animals/event_image_00000.npy");
  const auto array = read_npy(test_data("official/Animals/event_image_00000.npy"));
  ASSERT_TRUE(array.ok());
  EXPECT_EQ(array->shape, (std::vector<size_t>{720, 1280, 1}));
  EXPECT_EQ(array->type, "i4");
  EXPECT_EQ(array->to_float("x")->size(), 720U * 1280U);
}

}  // namespace
}  // namespace e2lf
