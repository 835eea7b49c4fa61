// SPDX-License-Identifier: MIT
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/capture/patterns/codes.h"
#include "testing/test_files.h"

namespace e2lf::capture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Codes grey_codes() {
  Codes codes(2, 2, 3);
  codes.values = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 1.0F};
  return codes;
}

Error json_error(const std::string& text) {
  const auto codes = codes_from_json(Json::parse(text), "c.json");
  EXPECT_FALSE(codes.ok()) << text;
  return codes.ok() ? Error{} : codes.error();
}

TEST(CodesJson, ReadsRowsOfNumbersAndOfText) {
  const auto codes = codes_from_json(Json::parse(R"({"patterns": [["000", [0, 0, 0]], [[0.25, 1, 0], "011"]]})"), "x");
  ASSERT_TRUE(codes.ok()) << codes.error().text();
  EXPECT_EQ(codes->num_patterns, 2U);
  EXPECT_EQ(codes->views_y, 2U);
  EXPECT_EQ(codes->views_x, 3U);
  EXPECT_THAT(codes->pattern(1), ElementsAre(0.25F, 1.0F, 0.0F, 0.0F, 1.0F, 1.0F));
}

TEST(CodesJson, WritesBinaryPatternsAsText) {
  EXPECT_EQ(codes_to_json(default_codes())["patterns"][1][4], "01100000");
  EXPECT_EQ(codes_to_json(default_codes())["patterns"][1][5], "11110000");
}

TEST(CodesJson, NamesUnknownKeysAndTheNearestKnownOne) {
  const Error error = json_error(R"({"pattern": [["01"]]})");
  EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error.location, "c.json: $.pattern");
  EXPECT_THAT(error.message, HasSubstr("patterns"));
}

TEST(CodesJson, NamesTheRowOfAnotherSize) {
  const Error row = json_error(R"({"patterns": [["01", "01"], ["01", "011"]]})");
  EXPECT_EQ(row.code, ErrorCode::kShape);
  EXPECT_EQ(row.location, "c.json: $.patterns[1][1]");
  const Error pattern = json_error(R"({"patterns": [["01", "01"], ["01"]]})");
  EXPECT_EQ(pattern.code, ErrorCode::kShape);
  EXPECT_EQ(pattern.location, "c.json: $.patterns[1]");
}

TEST(CodesJson, RefusesWhatIsNoPattern) {
  EXPECT_EQ(json_error("{}").code, ErrorCode::kFormat);
  EXPECT_EQ(json_error("[]").code, ErrorCode::kFormat);
  EXPECT_EQ(json_error(R"({"patterns": []})").code, ErrorCode::kShape);
  EXPECT_EQ(json_error(R"({"patterns": [[]]})").code, ErrorCode::kShape);
  EXPECT_EQ(json_error(R"({"patterns": [3]})").code, ErrorCode::kFormat);
  EXPECT_EQ(json_error(R"({"patterns": [[3]]})").code, ErrorCode::kFormat);
  EXPECT_EQ(json_error(R"({"patterns": [[["x"]]]})").code, ErrorCode::kFormat);
  EXPECT_EQ(json_error(R"({"patterns": [["0x"]]})").code, ErrorCode::kInvalidValue);
  EXPECT_EQ(json_error(R"({"patterns": [[[1.5]]]})").code, ErrorCode::kInvalidValue);
  EXPECT_EQ(json_error(R"({"patterns": [[[1e300]]]})").code, ErrorCode::kInvalidValue);
}

TEST(CodesFiles, RoundTripInEveryFormat) {
  const TestFolder folder;
  for (const Codes& codes : {grey_codes(), default_codes()}) {
    for (const char* name : {"c.json", "c.npy", "c.npz"}) {
      ASSERT_TRUE(write_codes(folder / name, codes).ok()) << name;
      const auto read = read_codes(folder / name);
      ASSERT_TRUE(read.ok()) << read.error().text();
      EXPECT_EQ(*read, codes) << name;
    }
  }
}

TEST(CodesFiles, ReadBooleanAndIntegerArrays) {
  NpyArray array = make_npy<uint8_t>({1, 2, 2}, std::vector<uint8_t>{0, 1, 1, 0});
  EXPECT_THAT(codes_from_npy(array, "x")->values, ElementsAre(0.0F, 1.0F, 1.0F, 0.0F));
  array.type = "b1";
  EXPECT_THAT(codes_from_npy(array, "x")->values, ElementsAre(0.0F, 1.0F, 1.0F, 0.0F));
}

TEST(CodesFiles, RefuseOtherShapesValuesAndFiles) {
  const TestFolder folder;
  EXPECT_EQ(codes_from_npy(make_npy<float>({4}, std::vector<float>(4)), "x").error().code, ErrorCode::kShape);
  EXPECT_EQ(codes_from_npy(make_npy<float>({0, 8, 8}, std::vector<float>()), "x").error().code, ErrorCode::kShape);
  EXPECT_EQ(codes_from_npy(make_npy<float>({1, 1, 1}, std::vector<float>{NAN}), "x").error().code,
            ErrorCode::kInvalidValue);
  EXPECT_EQ(codes_from_npy(make_npy<uint8_t>({1, 1, 1}, std::vector<uint8_t>{255}), "x").error().code,
            ErrorCode::kInvalidValue);
  EXPECT_EQ(read_codes(folder / "c.txt").error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(write_codes(folder / "c.txt", default_codes()).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(read_codes(folder / "none.json").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(write_npz(folder / "e.npz", {{"events", make_npy<uint8_t>({1}, std::vector<uint8_t>{1})}}).ok());
  EXPECT_EQ(read_codes(folder / "e.npz").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(write_npy(folder / "last.npy", make_npy<float>({8, 8, 4}, std::vector<float>(256))).ok());
  EXPECT_EQ(read_codes(folder / "last.npy").error().code, ErrorCode::kShape);
}

TEST(CodesText, DrawsPatternsSideBySide) {
  Codes codes(2, 2, 6);
  codes.pattern(1)[0] = 1.0F;
  codes.pattern(1)[7] = 0.5F;
  codes.pattern(1)[11] = 0.25F;
  EXPECT_EQ(codes_text(codes),
            "1: 0 %        2: 15 %\n"
            ". . . . . .   # . . . . .\n"
            ". . . . . .   . = . . . -\n");
}

TEST(CodesText, BreaksLinesAfterFourPatterns) {
  EXPECT_EQ(codes_text(Codes(5, 1, 1)),
            "1: 0 %      2: 0 %      3: 0 %      4: 0 %\n"
            ".           .           .           .\n"
            "\n"
            "5: 0 %\n"
            ".\n");
}

}  // namespace
}  // namespace e2lf::capture
