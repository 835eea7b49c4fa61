// SPDX-License-Identifier: MIT
#include "e2lf/capture/profile/sensor_profile.h"

#include <gtest/gtest.h>

namespace e2lf::capture {
namespace {

using enum PixelConstant;

Json pixel_camera() {
  Json constants = Json::object();
  for (size_t i = 0; i < kNumPixelConstants; ++i) {
    constants[pixel_constant_key(static_cast<PixelConstant>(i))] = {{"value", 0.25}, {"uncertainty", 0.1}};
  }
  return {
      {"name", "mine"},
      {"event_model", "pixel"},
      {"constants", constants},
      {"transmission",
       {{"value", {1.0, 1.1, 0.9}}, {"slope_x", {0.0, 0.25}}, {"slope_y", {0.0, -0.5, 0.5}}, {"uncertainty", 0.05}}}};
}

TEST(SensorProfile, ReadsWhatItWrites) {
  const auto camera = camera_from_json(pixel_camera(), "mine.json");
  ASSERT_TRUE(camera) << camera.error().text();
  EXPECT_EQ(camera->name, "mine");
  EXPECT_EQ(camera->pixel[kLitTime], 0.25F);
  EXPECT_EQ(camera->transmission, (std::vector<float>{1.0F, 1.1F, 0.9F}));
  const auto again = camera_from_json(to_json(*camera), "again");
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(again->pixel, camera->pixel);
  EXPECT_EQ(again->uncertainty, camera->uncertainty);
  EXPECT_EQ(again->transmission, camera->transmission);
  EXPECT_EQ(again->transmission_slope_x, (std::vector<float>{0.0F, 0.25F}));
  EXPECT_EQ(again->transmission_slope_y, camera->transmission_slope_y);
}

TEST(SensorProfile, TransmissionChangesOverTheField) {
  const auto camera = camera_from_json(pixel_camera(), "mine.json");
  ASSERT_TRUE(camera) << camera.error().text();
  EXPECT_FLOAT_EQ(transmission_at(*camera, 1, 0.0F, 0.0F), 1.1F);
  EXPECT_FLOAT_EQ(transmission_at(*camera, 1, 1.0F, -0.5F), 1.1F * std::exp(0.5F));
  EXPECT_FLOAT_EQ(transmission_at(*camera, 2, 1.0F, 0.5F), 0.9F * std::exp(0.25F));
  EXPECT_EQ(transmission_at(*camera, 3, 1.0F, 1.0F), 1.0F);
}

TEST(SensorProfile, NamesTheConstantThatIsMissingUnknownOrOutOfRange) {
  const auto error_of = [](const Json& json) { return camera_from_json(json, "mine.json").error().text(); };
  Json json = pixel_camera();
  json["constants"].erase("leak");
  EXPECT_NE(error_of(json).find("leak"), std::string::npos);
  json = pixel_camera();
  json["constants"]["leek"] = {{"value", 0.1}};
  EXPECT_NE(error_of(json).find("leek"), std::string::npos);
  json = pixel_camera();
  json["constants"]["threshold_on"]["value"] = 0;
  EXPECT_NE(error_of(json).find("threshold_on"), std::string::npos);
  json = pixel_camera();
  json["transmission"]["slope_x"] = {0, 0, 0, 0.1};
  EXPECT_NE(error_of(json).find("slopes"), std::string::npos);
  json = pixel_camera();
  json["transmission"]["slope_y"] = {0, 9};
  EXPECT_NE(error_of(json).find("slope"), std::string::npos);
  json = pixel_camera();
  json["event_model"] = "esim2";
  EXPECT_NE(error_of(json).find("event_model"), std::string::npos);
}

TEST(SensorProfile, TraitsTellHowFarACameraIsFromAnIdealOne) {
  SensorProfile camera;
  camera.constants = {.eps = 0.01F, .tau = 0.33F, .sigma_w = 0.1F, .sigma_z = 0.04F};
  const auto conditioning = conditioning_vector(camera, 4);
  ASSERT_EQ(conditioning.size(), conditioning_size(4));
  EXPECT_EQ(conditioning[0], 0.0F);
  EXPECT_NEAR(conditioning[1], 0.4F, 1e-5F);
  EXPECT_FLOAT_EQ(conditioning[3], 1.0F);
  EXPECT_FLOAT_EQ(conditioning[4], 1.0F);

  camera.event_model = "pixel";
  camera.pixel[kReceptorRate] = 30.0F;
  camera.pixel[kAmplifierRate] = 1e9F;
  camera.transmission = {1.0F, 1.1F};
  const auto of_pixel = conditioning_vector(camera, 4, 16);
  EXPECT_EQ(of_pixel[0], 1.0F);
  EXPECT_FLOAT_EQ(of_pixel[9], 0.5F);
  EXPECT_NEAR(of_pixel[10], 0.0F, 1e-6F);
  EXPECT_FLOAT_EQ(of_pixel[15], 1.0F);
  EXPECT_NEAR(of_pixel[16], 0.5F, 1e-5F);
  EXPECT_EQ(of_pixel[17], 0.0F);
}

}  // namespace
}  // namespace e2lf::capture
