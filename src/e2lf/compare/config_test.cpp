// SPDX-License-Identifier: MIT
#include "e2lf/compare/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/documented_keys.h"

namespace e2lf::compare {
namespace {

using testing::HasSubstr;

Json smallest() {
  return {{"methods", {{{"name", "inv"}, {"algorithm", "inversion"}}}},
          {"scenes", {{{"name", "rendered"}, {"scenes", {"demo"}}}}}};
}

std::string error_of(const Json& json) {
  const auto config = config_from_json(json, "c.json");
  return config ? "no error" : config.error().text();
}

TEST(Config, DefaultsAreThePaperAndOneSeed) {
  const auto config = config_from_json(smallest(), "c.json");
  ASSERT_TRUE(config) << config.error().text();
  ASSERT_EQ(config->sensors.size(), 1U);
  EXPECT_EQ(config->sensors[0].camera, "paper");
  EXPECT_EQ(config->seeds, std::vector<uint64_t>{1});
  EXPECT_EQ(config->methods[0].precision, "float32");
}

TEST(Config, ReadsEveryLevel) {
  Json json = smallest();
  json["sensors"] = {{{"name", "dim"}, {"tau", 0.2}, {"gain", 0.15}, {"cycles", 4}}};
  json["seeds"] = {3, 4};
  const auto config = config_from_json(json, "c.json");
  ASSERT_TRUE(config) << config.error().text();
  EXPECT_EQ(config->sensors[0].tau, 0.2F);
  EXPECT_EQ(config->sensors[0].cycles, 4U);
  EXPECT_FALSE(config->sensors[0].sigma_w);
  EXPECT_EQ(config->seeds[1], 4U);
}

TEST(Config, UnknownKeysNameTheirPlaceAndTheNearestKey) {
  Json json = smallest();
  json["methods"][0]["algoritm"] = "inversion";
  EXPECT_THAT(error_of(json), HasSubstr("$.methods[0].algoritm"));
  EXPECT_THAT(error_of(json), HasSubstr("algorithm"));
  json = smallest();
  json["scene"] = Json::array();
  EXPECT_THAT(error_of(json), HasSubstr("scenes"));
}

TEST(Config, RefusesWhatCannotBeMeant) {
  const auto with = [](const char* list, const char* key, Json value) {
    Json json = smallest();
    if (!json.contains(list)) json[list] = {{{"name", "a"}}};
    json[list][0][key] = std::move(value);
    return error_of(json);
  };
  EXPECT_THAT(with("methods", "algorithm", "inversoin"), HasSubstr("inversion"));
  EXPECT_THAT(with("methods", "algorithm", "network"), HasSubstr("network"));
  EXPECT_THAT(with("methods", "model", "m.safetensors"), HasSubstr("model"));
  EXPECT_THAT(with("methods", "command", {"true"}), HasSubstr("methods[0].command"));
  EXPECT_THAT(with("methods", "algorithm", "external"), HasSubstr("methods[0].command"));
  EXPECT_THAT(with("methods", "passes", 0), HasSubstr("give 1 to 64"));
  EXPECT_THAT(with("methods", "gain", -1), HasSubstr("positive number"));
  EXPECT_THAT(with("methods", "name", ""), HasSubstr("name"));
  EXPECT_THAT(with("scenes", "scenes", Json::array()), HasSubstr("scene"));
  EXPECT_THAT(with("scenes", "width", -3), HasSubstr("give a whole number from 0"));
  EXPECT_THAT(with("sensors", "tau", 0), HasSubstr("positive number"));
  EXPECT_THAT(with("sensors", "cycles", 65), HasSubstr("give 1 to 64"));
}

TEST(Config, RefusesNamesAndSeedsGivenTwice) {
  Json json = smallest();
  json["methods"].push_back(json["methods"][0]);
  EXPECT_THAT(error_of(json), HasSubstr("inv"));
  json = smallest();
  json["seeds"] = {1, 1};
  EXPECT_THAT(error_of(json), HasSubstr("seed"));
}

TEST(Config, RefusesUnknownMetricsAndOtherShapes) {
  Json json = smallest();
  json["metrics"] = {"psnr"};
  EXPECT_THAT(error_of(json), HasSubstr("psnr_db"));
  json = smallest();
  json["methods"] = "inversion";
  EXPECT_THAT(error_of(json), HasSubstr("expected a list"));
  EXPECT_THAT(error_of(Json::array()), HasSubstr("object"));
  json = smallest();
  json["methods"] = Json::array();
  EXPECT_THAT(error_of(json), HasSubstr("empty"));
}

TEST(Config, ThePageHasARowForEveryKey) {
  ComparisonConfig config;
  config.methods = {MethodConfig{}};
  config.scenes = {GroupConfig{}};
  config.sensors = {SensorConfig{}};
  EXPECT_EQ(undocumented_keys(to_json(config), page_text("compare.md")), std::vector<std::string>());
}

}  // namespace
}  // namespace e2lf::compare
