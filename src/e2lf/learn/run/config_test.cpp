// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/config.h"

#include <filesystem>
#include <gtest/gtest.h>

#include "testing/documented_keys.h"

namespace e2lf::learn {
namespace {

Error error_of(const std::string& text) {
  const auto config = config_from_json(Json::parse(text), "test");
  EXPECT_FALSE(config) << text;
  return config ? Error{} : config.error();
}

TEST(Config, ComesBackFromItsOwnJson) {
  Config config;
  config.name = "other";
  config.patterns.event_model = EventModel::kQuantised;
  config.input = {{model::InputKind::kCumulative, 0.5F}};
  config.sensor.gain = {0.5, 0.75};
  config.network.widths = {8};
  config.network.blocks = {3};
  config.train.optimiser = "adam";
  const auto again = config_from_json(to_json(config), "test");
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(to_json(*again), to_json(config));
  EXPECT_EQ(again->input, config.input);
}

TEST(Config, AnEmptyObjectIsTheDefault) {
  const auto config = config_from_json(Json::object(), "test");
  ASSERT_TRUE(config);
  EXPECT_EQ(to_json(*config), to_json(Config{}));
}

TEST(Config, ErrorsNameThePlaceAndTheNearestKey) {
  const auto unknown = error_of(R"({"train": {"bach": 3}})");
  EXPECT_EQ(unknown.code, ErrorCode::kInvalidValue);
  EXPECT_EQ(unknown.location, "test.train.bach");
  EXPECT_NE(unknown.message.find("batch"), std::string::npos);
  EXPECT_EQ(error_of(R"({"data": {"synthesiser": {"size": "big"}}})").location, "test.data.synthesiser.size");
}

TEST(Config, RefusesValuesThatCannotWork) {
  EXPECT_EQ(error_of(R"({"precision": "float16"})").location, "test.precision");
  EXPECT_EQ(error_of(R"({"patterns": {"event_model": "magic"}})").location, "test.patterns.event_model");
  EXPECT_EQ(error_of(R"({"patterns": {"black_first": false}, "input": [{"kind": "intensity"}]})").location,
            "test.input");
  EXPECT_EQ(error_of(R"({"patterns": {"complementary": true}})").location, "test.patterns");
  EXPECT_EQ(error_of(R"({"patterns": {"num_patterns": 1}})").location, "test.patterns");
  EXPECT_EQ(error_of(R"({"input": [{"kind": "colour"}]})").location, "test.input[0].kind");
  EXPECT_EQ(error_of(R"({"input": [{"kind": "images"}, {"kind": "counts"}]})").location, "test.input");
  EXPECT_EQ(error_of(R"({"input": [{"kind": "images"}], "sensor": {"camera": "evk4-lcos.json"}})").location,
            "test.sensor.camera");
  EXPECT_EQ(error_of(R"({"input": [{"kind": "lens-array"}]})").location, "test.patterns");
  EXPECT_EQ(error_of(R"({"input": [{"kind": "lens-array"}], "patterns": {"num_patterns": 1, "black_first": false},
                         "train": {"patch": 60}})")
                .location,
            "test.train.patch");
  EXPECT_EQ(error_of(R"({"input": [{"kind": "moved"}, {"kind": "counts"}]})").location, "test.input");
  EXPECT_EQ(error_of(R"({"network": {"type": "transformer"}})").location, "test.network");
  EXPECT_EQ(error_of(R"({"network": {"widths": [8]}})").location, "test.network");
  EXPECT_EQ(error_of(R"({"train": {"batch": 0}})").location, "test.train");
  EXPECT_EQ(error_of(R"({"train": {"optimiser": "sgd"}})").location, "test.train");
  EXPECT_EQ(error_of(R"({"train": {"patch": 128}})").location, "test.train.patch");
}

TEST(Config, ThePageHasARowForEveryKey) {
  Config config;
  config.input = {model::InputGroup{}};
  EXPECT_EQ(undocumented_keys(to_json(config), page_text("training.md")), std::vector<std::string>());
}

/// The configurations of the paper's methods, with what each measures.
TEST(Config, ThoseOfThePapersMethodsAreRead) {
  const std::filesystem::path folder = std::filesystem::path(E2LF_SOURCE_TREE) / "configs" / "paper";
  const std::vector<std::pair<const char*, capture::MeasurementKind>> methods = {
      {"bf-ra-n4", capture::MeasurementKind::kEventImages},
      {"bf-ra-n8", capture::MeasurementKind::kEventImages},
      {"bf-n4", capture::MeasurementKind::kEventImages},
      {"ra-n4", capture::MeasurementKind::kEventImages},
      {"baseline-n4", capture::MeasurementKind::kEventImages},
      {"event-only-complementary-n4", capture::MeasurementKind::kEventImages},
      {"hybrid-n4", capture::MeasurementKind::kHybrid},
      {"ca-n4", capture::MeasurementKind::kCodedImages},
      {"ca-n2", capture::MeasurementKind::kCodedImages},
      {"ca-n1", capture::MeasurementKind::kCodedImages},
      {"lens-array", capture::MeasurementKind::kLensArray}};
  const Json first = read_json(folder / "bf-ra-n4.json").value();
  for (const auto& [name, measurement] : methods) {
    const auto json = read_json(folder / (std::string(name) + ".json"));
    ASSERT_TRUE(json) << name;
    const auto config = config_from_json(*json, name);
    ASSERT_TRUE(config) << config.error().text();
    EXPECT_EQ(config->name, name);
    EXPECT_EQ(model::measurement_of(config->input).value(), measurement) << name;
    for (const char* key : {"data", "sensor", "network", "train", "precision"}) {
      EXPECT_EQ((*json)[key], first[key]) << name << ": budgets are equal";
    }
  }
}

TEST(MakeNetwork, FitsTheInputAndTheViews) {
  Config config;
  config.patterns.num_patterns = 8;
  const auto network = make_network(config);
  EXPECT_EQ(network.input_channels, 21U);
  EXPECT_EQ(network.layers.back().out_channels, 64U);
  config.network.type = "recnet";
  config.input = {{model::InputKind::kCounts, 0.125F}};
  EXPECT_EQ(make_network(config).input_channels, 7U);
}

}  // namespace
}  // namespace e2lf::learn
