// SPDX-License-Identifier: MIT
#include "e2lf/recon/reconstruct.h"

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

namespace e2lf::recon {
namespace {

/// Two patterns; view v is v times the count. Pixel (un)shuffle by 2 makes the network take even sizes only.
model::Model toy_model() {
  model::Model model;
  model.name = "toy";
  model.num_patterns = 2;
  model.input = {{model::InputKind::kCounts, 0.5F}};
  model.network.input_channels = 1;
  model.network.layers = {
      {.name = "down", .op = model::Op::kPixelUnshuffle, .inputs = {"input"}, .stride = 2, .residual = ""},
      {.name = "up", .op = model::Op::kPixelShuffle, .inputs = {"down"}, .stride = 2, .residual = ""},
      {.name = "views", .op = model::Op::kConv, .inputs = {"up"}, .out_channels = 64, .residual = ""}};
  for (int view = 0; view < 64; ++view) model.weights["views.weight"].push_back(2.0F * static_cast<float>(view));
  model.weights["views.bias"] = std::vector<float>(64);
  return model;
}

TEST(Reconstructor, OddSizesAreExtendedAndCropped) {
  const auto reconstructor = Reconstructor::create(toy_model(), {engine::Precision::kFloat32});
  ASSERT_TRUE(reconstructor) << reconstructor.error().text();
  events::EventImages images(1, 5, 7);
  for (size_t i = 0; i < images.counts.size(); ++i) images.counts[i] = static_cast<int16_t>(i) - 9;
  const auto light_field = reconstructor->reconstruct(images);
  ASSERT_TRUE(light_field) << light_field.error().text();
  ASSERT_EQ(light_field->shape(), (lightfield::Shape{8, 8, 5, 7}));
  for (size_t view = 0; view < 64; ++view) {
    for (size_t i = 0; i < 35; ++i) {
      ASSERT_NEAR(light_field->view(view / 8, view % 8)[i], static_cast<float>(view) * images.counts[i], 1e-3);
    }
  }
}

TEST(Reconstructor, EventImagesMustFitTheModel) {
  const auto reconstructor = Reconstructor::create(toy_model());
  ASSERT_TRUE(reconstructor);
  EXPECT_EQ(reconstructor->reconstruct(events::EventImages(3, 4, 4)).error().code, ErrorCode::kShape);
  EXPECT_EQ(reconstructor->reconstruct(events::EventImages(1, 0, 4)).error().code, ErrorCode::kShape);
}

TEST(Reconstructor, BrokenModelIsRefused) {
  model::Model model = toy_model();
  model.weights.erase("views.bias");
  EXPECT_FALSE(Reconstructor::create(std::move(model)));
}

}  // namespace
}  // namespace e2lf::recon
