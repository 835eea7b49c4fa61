// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/files/npy.h"
#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/data/packed_data.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "testing/test_training_data.h"
#include "testing/textured_plane.h"

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

/// A textured plane at 0.5 px per view step, with and without true disparities in its folder.
TEST(Pack, KeepsTrueDisparitiesAndThoseThatItIsToldToEstimate) {
  constexpr int64_t kHeight = 48, kWidth = 56;
  const TestData data;
  const auto& folder = data.folder();
  for (const char* scene : {"true", "other"}) {
    const auto field = lightfield::render_light_field(lightfield::textured_plane_scene(0.5F), {8, 8, kHeight, kWidth});
    ASSERT_TRUE(lightfield::write_light_field(folder / scene, field));
  }
  std::vector<float> truth(kHeight * kWidth, 0.5F);
  truth[3] = std::numeric_limits<float>::quiet_NaN();
  ASSERT_TRUE(write_npy(folder / "true" / "gt_disparity.npy", make_npy<float>({kHeight, kWidth}, truth)));
  PackOptions options{.light_fields = {folder / "true", folder / "other"}};
  ASSERT_EQ(pack(folder / "kept.safetensors", options)->with_disparity, 1U);
  const auto kept = read_dataset(folder / "kept.safetensors", torch::kCPU).value();
  EXPECT_FALSE(kept.find("other").value()->disparity.defined());
  const auto maps = kept.find("true").value()->disparity;
  ASSERT_EQ(maps.sizes(), (at::IntArrayRef{4, kHeight, kWidth}));
  EXPECT_FALSE(maps.narrow(0, 0, 3).isfinite().any().item<bool>());
  EXPECT_EQ(maps[3].isfinite().sum().item<int64_t>(), kHeight * kWidth - 1);
  EXPECT_EQ(maps[3][1][0].item<float>(), 0.5F);

  options.estimate_disparity = true;
  ASSERT_EQ(pack(folder / "estimated.safetensors", options)->with_disparity, 2U);
  const auto estimated = read_dataset(folder / "estimated.safetensors", torch::kCPU).value();
  for (const char* scene : {"true", "other"}) {
    const auto found = estimated.find(scene).value()->disparity;
    EXPECT_GT(found.isfinite().to(torch::kFloat).mean().item<float>(), 0.5F) << scene;
    EXPECT_NEAR(found.nanmedian().item<float>(), 0.5F, 0.02F) << scene;
  }
  ASSERT_TRUE(write_npy(folder / "true" / "gt_disparity.npy", make_npy<float>({2, 2}, std::vector<float>(4))));
  EXPECT_EQ(pack(folder / "wrong.safetensors", options).error().code, ErrorCode::kShape);
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
