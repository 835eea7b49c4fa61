// SPDX-License-Identifier: MIT
#include "e2lf/files/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/test_files.h"

namespace e2lf {
namespace {

using testing::HasSubstr;

struct Train {
  int batch = 8;
  double rate = 0.5;
  std::string name = "default";
  std::optional<int> steps;
};

Result<Train> read_train(const Json& json) {
  Train train;
  OptionReader reader(json, "c.json: $");
  reader.read("batch", train.batch).read("rate", train.rate).read("name", train.name).read("steps", train.steps);
  E2LF_RETURN_IF_ERROR(reader.finish());
  return train;
}

TEST(OptionReader, ReadsWhatIsThereAndKeepsDefaults) {
  const auto train = read_train(Json::parse(R"({"batch": 16, "steps": 3})"));
  ASSERT_TRUE(train.ok());
  EXPECT_EQ(train->batch, 16);
  EXPECT_EQ(train->rate, 0.5);
  EXPECT_EQ(train->name, "default");
  EXPECT_EQ(train->steps, 3);
  EXPECT_FALSE(read_train(Json())->steps.has_value());
}

TEST(OptionReader, RefusesATextThatIsNotUtf8) {
  Json config = Json::object();
  ASSERT_TRUE(apply_override(config, "batch=\xff").ok());
  EXPECT_EQ(read_train(config).error().code, ErrorCode::kInvalidValue);
}

TEST(OptionReader, NamesTheNearestKnownKey) {
  const Error error = read_train(Json::parse(R"({"bacth": 16})")).error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
  EXPECT_THAT(error.message, HasSubstr("batch"));
  EXPECT_EQ(error.location, "c.json: $.bacth");
}

TEST(OptionReader, NamesTheKeyOfTheWrongType) {
  const Error error = read_train(Json::parse(R"({"batch": "many"})")).error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error.location, "c.json: $.batch");
  EXPECT_EQ(read_train(Json::parse("[1]")).error().code, ErrorCode::kFormat);
}

TEST(OptionReader, RefusesNumbersThatTheFieldCannotHold) {
  const auto fits = [](auto field, const char* text) {
    const Json json = {{"field", Json::parse(text)}};
    OptionReader reader(json, "$");
    reader.read("field", field);
    return reader.finish().ok();
  };
  EXPECT_TRUE(fits(size_t{}, "3"));
  EXPECT_FALSE(fits(size_t{}, "-3"));
  EXPECT_FALSE(fits(size_t{}, "3.5"));
  EXPECT_FALSE(fits(size_t{}, "true"));
  EXPECT_FALSE(fits(uint8_t{}, "256"));
  EXPECT_TRUE(fits(int{}, "-3"));
  EXPECT_FALSE(fits(int{}, "3000000000"));
  EXPECT_TRUE(fits(float{}, "3"));
  EXPECT_FALSE(fits(float{}, "true"));
  EXPECT_TRUE(fits(bool{}, "true"));
  EXPECT_FALSE(fits(bool{}, "1"));
  EXPECT_FALSE(fits(std::string(), "1"));
}

TEST(JsonNumber, IsShortAndReadsBackAsTheSameFloat) {
  EXPECT_EQ(json_number(0.3F).dump(), "0.3");
  for (const float value : {0.1F, 1.0F / 3, 1e-40F, -3.4e38F, 0.0F}) EXPECT_EQ(json_number(value).get<float>(), value);
}

TEST(JsonText, NeverThrowsForBytesThatAreNoUtf8) {
  const Json json = {{"path",
                      "a\xff"
                      "b"}};
  EXPECT_EQ(json_line(json),
            "{\"path\":\"a\xef\xbf\xbd"
            "b\"}");
  EXPECT_EQ(json_text(json),
            "{\n  \"path\": \"a\xef\xbf\xbd"
            "b\"\n}\n");
}

TEST(OptionReader, ReadsNestedObjects) {
  const Json json = Json::parse(R"({"train": {"batch": 2, "x": 1}})");
  OptionReader outer(json, "c.json: $");
  int batch = 0;
  OptionReader inner(outer.child("train"), outer.child_location("train"));
  inner.read("batch", batch);
  EXPECT_EQ(batch, 2);
  EXPECT_TRUE(outer.finish().ok());
  EXPECT_EQ(inner.finish().error().location, "c.json: $.train.x");
}

TEST(ParseJson, AllowsCommentsAndNamesTheByteOfAMistake) {
  EXPECT_TRUE(parse_json("{ // why\n \"a\": 1 }", "c.json").ok());
  const auto nested = [](size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_TRUE(parse_json(nested(64), "c.json").ok());
  EXPECT_TRUE(parse_json("[\"" + nested(100) + "\\\"" + nested(100) + "\"]", "c.json").ok()) << "brackets in text";
  EXPECT_EQ(parse_json(nested(65), "c.json").error().code, ErrorCode::kFormat);
  const Error error = parse_json("{\"a\": }", "c.json").error();
  EXPECT_EQ(error.code, ErrorCode::kFormat);
  EXPECT_EQ(error.location, "c.json: byte 7");
}

TEST(ParseJson, RefusesNumbersBeyondEveryDouble) {
  const Error error = parse_json(R"({"tau": 555555e555})", "c.json").error();
  EXPECT_EQ(error.code, ErrorCode::kFormat);
  EXPECT_NE(error.message.find("555555e555"), std::string::npos) << error.message;
}

TEST(ReadJson, NamesTheMissingFile) {
  const TestFolder folder;
  EXPECT_EQ(read_json(folder / "none.json").error().code, ErrorCode::kNotFound);
}

TEST(ApplyOverride, SetsNestedValuesOfEveryType) {
  Json config = Json::parse(R"({"train": {"batch": 8}})");
  ASSERT_TRUE(apply_override(config, "train.batch=16").ok());
  ASSERT_TRUE(apply_override(config, "train.name=a=b").ok());
  ASSERT_TRUE(apply_override(config, "data.scenes=[1, 2]").ok());
  EXPECT_EQ(config, Json::parse(R"({"train": {"batch": 16, "name": "a=b"}, "data": {"scenes": [1, 2]}})"));
}

TEST(ApplyOverride, RefusesWhatIsNoAssignmentOrGoesThroughAValue) {
  Json config = Json::parse(R"({"train": {"batch": 8}})");
  EXPECT_EQ(apply_override(config, "train.batch").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(apply_override(config, "=3").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(apply_override(config, "train.batch.size=3").error().code, ErrorCode::kInvalidValue);
  for (const Json& no_object : {Json("text"), Json(3), Json::array({1})}) {
    Json other = no_object;
    EXPECT_EQ(apply_override(other, "batch=3").error().code, ErrorCode::kInvalidValue) << other;
    EXPECT_EQ(other, no_object);
  }
  EXPECT_EQ(config, Json::parse(R"({"train": {"batch": 8}})"));
}

}  // namespace
}  // namespace e2lf
