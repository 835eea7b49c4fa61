// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/data/packed_data.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "testing/test_training_data.h"

namespace e2lf::learn {
namespace {

TEST(Pack, KeepsEveryByteOfLightFieldsAndPictures) {
  const TestData data;
  const auto& folder = data.folder();
  lightfield::LightField field({8, 8, 12, 16});
  for (size_t i = 0; i < field.data().size(); ++i) field.data()[i] = static_cast<float>(i % 256) / 255.0F;
  ASSERT_TRUE(lightfield::write_light_field(folder / "scene", field));
  lightfield::Image picture(64, 70, 1);
  for (size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] = static_cast<float>(i % 251) / 255.0F;
  std::filesystem::create_directories(folder / "photos");
  ASSERT_TRUE(lightfield::write_png(folder / "photos" / "one.png", picture));

  const auto output = folder / "out.safetensors";
  const auto summary = pack(output, {.light_fields = {folder / "scene/"}, .textures = {folder / "photos"}});
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_EQ(summary->light_fields, 1U);
  EXPECT_EQ(summary->textures, 1U);
  EXPECT_EQ(summary->bytes, 64U * 12 * 16 + 64 * 70);

  const auto dataset = read_dataset(output, torch::kCPU);
  ASSERT_TRUE(dataset) << dataset.error().text();
  const auto scene = dataset->find("scene");
  ASSERT_TRUE(scene);
  const auto expected = torch::arange(64 * 12 * 16).remainder(256).to(torch::kByte).reshape({64, 12, 16});
  EXPECT_TRUE(torch::equal((*scene)->views, expected));
  EXPECT_TRUE(
      torch::equal(dataset->textures.at(0), torch::arange(64 * 70).remainder(251).to(torch::kByte).reshape({70, 64})));

  EXPECT_EQ(pack(output, {.light_fields = {folder / "scene"}}).error().code, ErrorCode::kExists);
}

TEST(Pack, RefusesNothingNamesTwiceAndSmallPictures) {
  const TestData data;
  const auto output = data.folder() / "out.safetensors";
  EXPECT_EQ(pack(output, {}).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(pack(output, {.textures = {data.folder() / "none"}}).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(lightfield::write_png(data.folder() / "a.png", lightfield::Image(64, 64, 1)));
  ASSERT_TRUE(lightfield::write_png(data.folder() / "small.png", lightfield::Image(64, 63, 1)));
  EXPECT_EQ(pack(output, {.textures = {data.folder() / "a.png", data.folder() / "a.png"}}).error().code,
            ErrorCode::kInvalidValue);
  EXPECT_EQ(pack(output, {.textures = {data.folder() / "small.png"}}).error().location,
            (data.folder() / "small.png").string());
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace e2lf::learn
