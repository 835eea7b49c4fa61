// SPDX-License-Identifier: MIT
#include "e2lf/recon/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <set>

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

/// One image of 5x7 whose counts are -9, -8, ...
capture::EventImages numbered_images() {
  capture::EventImages images(1, 5, 7);
  std::iota(images.values.begin(), images.values.end(), int16_t{-9});
  return images;
}

TEST(Reconstructor, OddSizesAreExtendedAndCropped) {
  const auto reconstructor = Reconstructor::create(toy_model(), {engine::Precision::kFloat32});
  ASSERT_TRUE(reconstructor) << reconstructor.error().text();
  const capture::EventImages images = numbered_images();
  const auto light_field = reconstructor->reconstruct(images);
  ASSERT_TRUE(light_field) << light_field.error().text();
  ASSERT_EQ(light_field->shape(), (lightfield::Shape{8, 8, 5, 7}));
  for (size_t view = 0; view < 64; ++view) {
    for (size_t i = 0; i < 35; ++i) {
      ASSERT_NEAR(light_field->view(view / 8, view % 8)[i], static_cast<float>(view) * images.values[i], 1e-3);
    }
  }
}

TEST(Reconstructor, ReadsAndWritesMemoryWithStrides) {
  const auto reconstructor = Reconstructor::create(toy_model(), {engine::Precision::kFloat32}).value();
  const capture::EventImages images = numbered_images();
  std::vector<int16_t> wide(5 * 14);
  const PlanesView<int16_t> every_second(wide.data(), {1, 5, 7}, {0, 14, 2});
  copy_values(PlanesView<const int16_t>(images), every_second);
  // The views in reversed order, with the pixels of two light fields taking turns.
  std::vector<float> memory(2 * 64 * 35, -1.0F);
  const LightFieldOutput output =
      LightFieldOutput(memory.data(), {8, 8, 5, 7, 1}, {560, 70, 14, 2, 0}).reversed(0).reversed(1);
  ReconstructionMemory scratch;
  ASSERT_TRUE(reconstructor.reconstruct_into(PlanesView<const int16_t>(every_second), 1, {}, scratch, output));
  EXPECT_TRUE(std::ranges::equal(lightfield::LightField(output).data(), reconstructor.reconstruct(images)->data()));
  for (size_t i = 1; i < memory.size(); i += 2) ASSERT_EQ(memory[i], -1.0F);
}

/// View 0 is the intensity that the camera's threshold gives a count, view 1 the trait that tells it from the paper's,
/// view 2 the one of several cycles.
model::Model conditioned_model() {
  model::Model model = toy_model();
  model.input = {{model::InputKind::kIntensity, 1.0F}, {model::InputKind::kCamera, 1.0F}};
  const size_t channels = model::num_input_channels(model.input, 2);
  model.network.input_channels = channels;
  model.network.layers = {
      {.name = "views", .op = model::Op::kConv, .inputs = {"input"}, .out_channels = 64, .residual = ""}};
  auto& weights = model.weights["views.weight"];
  weights.assign(64 * channels, 0.0F);
  weights[0] = weights[channels + 1] = weights[2 * channels + 16] = 1.0F;
  return model;
}

TEST(Reconstructor, TellsTheNetworkTheCameraAndTheCycles) {
  model::Model model = conditioned_model();
  capture::SensorProfile& camera = model.camera.emplace();
  camera.event_model = "pixel";
  camera.constants = {.eps = 0.02F, .tau = 0.4F};
  const auto reconstructor = Reconstructor::create(model, {engine::Precision::kFloat32});
  ASSERT_TRUE(reconstructor) << reconstructor.error().text();
  capture::EventImages images(1, 2, 2);
  images.values.assign(4, 2);
  const auto once = reconstructor->reconstruct(images).value();
  EXPECT_NEAR(once.view(0, 0)[0], 0.02 * std::expm1(0.4 * 2.5), 1e-6);
  EXPECT_NEAR(once.view(0, 1)[0], 1.0, 1e-6);
  EXPECT_NEAR(once.view(0, 2)[0], 0.0, 1e-6);
  const auto four = reconstructor->reconstruct(images, {}, 1, 4).value();
  EXPECT_NEAR(four.view(0, 0)[0], 0.02 * std::expm1(0.4 * 1.0), 1e-6);
  EXPECT_NEAR(four.view(0, 2)[0], 0.5, 1e-6);
}

/// Every view is the count times 1, 2, 3 or 4, by where the pixel falls on the network's grid of 2x2.
model::Model uneven_model() {
  model::Model model = toy_model();
  auto& layers = model.network.layers;
  layers[1].inputs = {"weigh"};
  layers.insert(layers.begin() + 1,
                {.name = "weigh", .op = model::Op::kConv, .inputs = {"down"}, .out_channels = 4, .residual = ""});
  for (size_t i = 0; i < 16; ++i) model.weights["weigh.weight"].push_back(i % 5 == 0 ? 1.0F + i / 5 : 0.0F);
  model.weights["weigh.bias"] = std::vector<float>(4);
  model.weights["views.weight"].assign(64, 2.0F);
  return model;
}

TEST(Reconstructor, SharesItsEngineWithTheSameNetworkToldAnotherCamera) {
  capture::SensorProfile camera;
  camera.constants.tau = 0.5F;
  model::Model told = conditioned_model();
  told.camera = camera;
  const auto expected = Reconstructor::create(told)->reconstruct(numbered_images());
  const Reconstructor first = Reconstructor::create(conditioned_model()).value(), second = first.with_camera(camera);
  EXPECT_EQ(&second.engine(), &first.engine());
  EXPECT_TRUE(std::ranges::equal(second.reconstruct(numbered_images())->data(), expected->data()));
  EXPECT_FALSE(std::ranges::equal(first.reconstruct(numbered_images())->data(), expected->data()));
}

TEST(Reconstructor, PassesAverageOverTheGrid) {
  const auto reconstructor = Reconstructor::create(uneven_model(), {engine::Precision::kFloat32});
  ASSERT_TRUE(reconstructor) << reconstructor.error().text();
  const capture::EventImages images = numbered_images();
  const auto once = reconstructor->reconstruct(images);
  EXPECT_EQ(reconstructor->num_passes(9), 4U);
  EXPECT_EQ(reconstructor->num_passes(3), 3U);
  size_t last = 0;
  // More than the four there are make four.
  const auto mean = reconstructor->reconstruct(
      images, [&](size_t done, size_t total) { last = done == total ? done : 0; }, 9);
  ASSERT_TRUE(once && mean);
  EXPECT_GT(last, 0U);
  ASSERT_EQ(mean->shape(), (lightfield::Shape{8, 8, 5, 7}));
  for (size_t i = 0; i < 35; ++i) {
    const auto factor = static_cast<float>(1 + 2 * (i / 7 % 2) + i % 7 % 2);
    ASSERT_NEAR(once->view(3, 5)[i], factor * images.values[i], 1e-4);
    ASSERT_NEAR(mean->view(3, 5)[i], 2.5F * images.values[i], 1e-4);
  }
}

TEST(GridShifts, AreDistinctAndBeginWithNone) {
  for (const size_t side : {1, 2, 3, 4, 5, 6, 8, 16}) {
    const auto shifts = grid_shifts(1000, side);
    ASSERT_EQ(shifts.size(), side * side);
    EXPECT_EQ(shifts.front(), GridShift());
    std::set<std::pair<size_t, size_t>> distinct;
    for (const GridShift& shift : shifts) {
      EXPECT_LT(std::max(shift.y, shift.x), side);
      distinct.insert({shift.y, shift.x});
    }
    EXPECT_EQ(distinct.size(), shifts.size());
  }
  EXPECT_EQ(grid_shifts(2, 8).size(), 2U);
}

TEST(GridShifts, FourCoverTheFinestGrid) {
  for (const size_t side : {2, 4, 6, 8, 10, 16}) {
    std::set<std::pair<size_t, size_t>> phases;
    for (const GridShift& shift : grid_shifts(4, side)) phases.insert({shift.y % 2, shift.x % 2});
    EXPECT_EQ(phases.size(), 4U) << side;
  }
}

TEST(Reconstructor, EventImagesMustFitTheModel) {
  const auto reconstructor = Reconstructor::create(toy_model());
  ASSERT_TRUE(reconstructor);
  EXPECT_EQ(reconstructor->reconstruct(capture::EventImages(3, 4, 4)).error().code, ErrorCode::kShape);
  EXPECT_EQ(reconstructor->reconstruct(capture::EventImages(1, 0, 4)).error().code, ErrorCode::kShape);
}

TEST(Reconstructor, BrokenModelIsRefused) {
  model::Model model = toy_model();
  model.weights.erase("views.bias");
  EXPECT_FALSE(Reconstructor::create(std::move(model)));
}

}  // namespace
}  // namespace e2lf::recon
