// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/video/video_model.h"
#include "testing/video_networks.h"

namespace e2lf::video {
namespace {

video::VideoModel model_with(model::Network network, size_t pad_multiple) {
  video::VideoModel model;
  model.name = "test";
  model.bins = network.input_channels;
  model.pad_multiple = pad_multiple;
  model.network = std::move(network);
  model.weights = engine::random_weights(model.network, 3);
  return model;
}

/// One 3x3 convolution that counts the pixels around that have any bin's value, and those padding adds not.
TEST(EventVideo, PadsAboveAndToTheLeftFirstAndCutsBack) {
  video::VideoModel model = model_with({1, {engine::conv("a", "input", 1, 3, false)}}, 4);
  model.weights = {{"a.weight", {0, 0, 0, 0, 0, 1, 0, 0, 0}}, {"a.bias", {0.5F}}};  // the pixel to the right
  EventVideo video = EventVideo::create(model, 5, 3, {engine::Precision::kFloat32}).value();
  capture::VoxelGrid grid(1, 5, 3);
  for (size_t i = 0; i < grid.values.size(); ++i) grid.values[i] = static_cast<float>(i + 1);
  const auto frame = video.next(grid).value();
  for (size_t y = 0; y < 5; ++y) {
    for (size_t x = 0; x < 3; ++x) {
      EXPECT_FLOAT_EQ(frame[y * 3 + x], 0.5F + (x + 1 < 3 ? grid.values[y * 3 + x + 1] : 0.0F)) << y << " " << x;
    }
  }
}

TEST(EventVideo, PaddingOnAllSidesIsThatOfALargerGrid) {
  const auto networks = recurrent_networks();
  const video::VideoModel model = model_with({5, networks[0].network.layers}, 4);
  EventVideo video = EventVideo::create(model, 6, 9, {engine::Precision::kFloat32}).value();
  EventVideo whole = EventVideo::create(model, 8, 12, {engine::Precision::kFloat32}).value();
  for (uint64_t frame = 0; frame < 3; ++frame) {
    capture::VoxelGrid grid(5, 6, 9), padded(5, 8, 12);
    grid.values = engine::random_values(grid.values.size(), frame);
    for (size_t row = 0; row < 5 * 6; ++row) {
      // 2 rows more: one above; 3 columns more: two to the left.
      std::copy_n(&grid.values[row * 9], 9, &padded.values[(row / 6 * 8 + row % 6 + 1) * 12 + 2]);
    }
    const auto small = video.next(grid).value(), large = whole.next(padded).value();
    for (size_t y = 0; y < 6; ++y) {
      for (size_t x = 0; x < 9; ++x) EXPECT_EQ(small[y * 9 + x], large[(y + 1) * 12 + x + 2]) << frame;
    }
  }
}

TEST(EventVideo, NormalisesWhereTheModelSaysSoAndForgetsWhenTold) {
  video::VideoModel model = model_with({5, recurrent_networks()[0].network.layers}, 1);
  EventVideo plain = EventVideo::create(model, 8, 8, {engine::Precision::kFloat32}).value();
  model.normalises_voxels = true;
  EventVideo normalising = EventVideo::create(model, 8, 8, {engine::Precision::kFloat32}).value();
  capture::VoxelGrid grid(5, 8, 8);
  grid.values = engine::random_values(grid.values.size(), 1, 5.0F);
  const auto first = normalising.next(grid).value();
  EXPECT_NE(first, plain.next(grid).value());
  plain.reset();
  capture::VoxelGrid normal = grid;
  normalise_nonzero(normal.values);
  EXPECT_EQ(first, plain.next(normal).value());
}

TEST(EventVideo, RefusesAModelThatDoesNotFit) {
  video::VideoModel model = model_with({5, recurrent_networks()[0].network.layers}, 1);
  model.bins = 3;
  EXPECT_FALSE(EventVideo::create(model, 8, 8).ok());
}

}  // namespace
}  // namespace e2lf::video
