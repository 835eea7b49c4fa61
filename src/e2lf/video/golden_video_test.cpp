// SPDX-License-Identifier: MIT
// Published weights give the published networks' frames.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

#include "e2lf/files/npy.h"
#include "e2lf/video/import_event_video.h"
#include "e2lf/video/video_model.h"

namespace e2lf::video {
namespace {

namespace fs = std::filesystem;

constexpr size_t kFrames = 4, kBins = 5, kVideoSide = 64;

class GoldenVideo : public testing::TestWithParam<const char*> {};

TEST_P(GoldenVideo, FramesEqualThoseOfThePublishedNetwork) {
  const char* data = std::getenv("E2LF_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : "") / "e2v";
  const std::string name = GetParam();
  if (data == nullptr || !fs::exists(folder / (name + ".safetensors"))) GTEST_SKIP() << "E2LF_DATA/e2v is absent";
  auto model = video::import_event_video(folder / (name + ".safetensors"));
  ASSERT_TRUE(model) << model.error().text();
  const auto voxels = read_npy(folder / "golden_voxels_4x5x64x64.npy").value().to_float("voxels").value();
  const auto golden = read_npy(folder / ("golden_" + name + "_4x64x64.npy")).value().to_float("golden").value();
  ASSERT_EQ(voxels.size(), kFrames * kBins * kVideoSide * kVideoSide);
  ASSERT_EQ(golden.size(), kFrames * kVideoSide * kVideoSide);
  EventVideo video =
      EventVideo::create(*std::move(model), kVideoSide, kVideoSide, {engine::Precision::kFloat32}).value();
  double largest = 0.0;
  for (size_t frame = 0; frame < kFrames; ++frame) {
    capture::VoxelGrid grid(kBins, kVideoSide, kVideoSide);
    std::copy_n(voxels.begin() + static_cast<ptrdiff_t>(frame * grid.values.size()), grid.values.size(),
                grid.values.begin());
    const auto picture = video.next(std::move(grid)).value();
    for (size_t i = 0; i < picture.size(); ++i) {
      const double error = std::abs(static_cast<double>(picture[i]) - golden[frame * kVideoSide * kVideoSide + i]);
      largest = error <= largest ? largest : error;
    }
  }
  RecordProperty("largest_difference", std::to_string(largest));
  EXPECT_LT(largest, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Networks, GoldenVideo, testing::Values("FireNet", "FireNetPlus"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace e2lf::video
