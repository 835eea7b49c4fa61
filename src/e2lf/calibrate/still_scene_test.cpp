// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/still_scene.h"

#include <gtest/gtest.h>
#include <set>

#include "e2lf/base/rng.h"
#include "testing/test_still_scenes.h"

namespace e2lf::calibrate {
namespace {

/// Some pixels of a scene, the same for the same stream.
std::set<size_t> draw_pixels(const StillScene& scene, size_t number, uint64_t stream) {
  std::set<size_t> pixels;
  const auto size = static_cast<uint32_t>(scene.cycles.front().image_size());
  for (uint64_t i = 0; pixels.size() < number; ++i) pixels.insert(CounterRng(1, stream).below(i, size));
  return pixels;
}

/// Adds ON events of a rate of 500 per second, about five in each pattern of 10.4 ms.
void make_hot(StillScene& scene, const std::set<size_t>& pixels) {
  uint64_t draw = 0;
  for (auto& cycle : scene.cycles) {
    for (size_t n = 0; n < cycle.count; ++n) {
      for (const size_t p : pixels) {
        for (int chance = 0; chance < 104; ++chance) {
          cycle.image(n)[p] =
              static_cast<int16_t>(cycle.image(n)[p] + (CounterRng(2, 0).uniform(draw++) < 0.05F ? 1 : 0));
        }
      }
    }
  }
}

TEST(BadPixels, HotOnesAreFoundAndOthersAreNot) {
  for (const size_t cycles : {size_t{1}, size_t{8}}) {
    StillScene scene = simulate(plain_camera(), patches(0.02F, 1.5F), cycles);
    const auto hot = draw_pixels(scene, 300, 1);
    make_hot(scene, hot);
    const auto states = find_bad_pixels({scene});
    size_t found = 0, wrong = 0;
    for (size_t p = 0; p < states.size(); ++p) {
      (hot.contains(p) ? found : wrong) += states[p] == PixelState::kHot ? 1 : 0;
    }
    EXPECT_GE(found, 285U) << cycles << " cycles";
    EXPECT_LE(wrong, states.size() / 10'000) << cycles << " cycles";
  }
}

TEST(BadPixels, DeadOnesAreFoundWhereThereIsLight) {
  StillScene scene = simulate(plain_camera(), patches(1.0F, 3.0F), 2);
  const auto dead = draw_pixels(scene, 300, 2);
  for (auto& cycle : scene.cycles) {
    for (size_t n = 0; n < cycle.count; ++n) {
      for (const size_t p : dead) cycle.image(n)[p] = 0;
    }
  }
  const auto states = find_bad_pixels({scene});
  size_t found = 0, wrong = 0;
  for (size_t p = 0; p < states.size(); ++p) {
    (dead.contains(p) ? found : wrong) += states[p] == PixelState::kDead ? 1 : 0;
  }
  EXPECT_GE(found, 285U);
  EXPECT_LE(wrong, states.size() / 1000);
}

TEST(BadPixels, TakeTheMedianOfTheirNeighboursInMeans) {
  StillScene scene{{capture::EventImages(1, 64, 64)}};
  std::fill(scene.cycles[0].values.begin(), scene.cycles[0].values.end(), 2);
  scene.cycles[0].values[130] = 90;
  const auto states = find_bad_pixels({scene});
  EXPECT_EQ(states[130], PixelState::kHot);
  EXPECT_EQ(mean_counts(scene, states)[0].data()[130], 2.0F);
}

TEST(StillScenes, AreRefusedWhereTheyDoNotFit) {
  const StillScene good{{capture::EventImages(3, 64, 64)}};
  EXPECT_TRUE(check_scenes({good}));
  EXPECT_EQ(check_scenes({}).error().code, ErrorCode::kShape);
  EXPECT_EQ(check_scenes({StillScene{{capture::EventImages(0, 64, 64)}}}).error().code, ErrorCode::kShape);
  EXPECT_EQ(check_scenes({StillScene{{capture::EventImages(3, 64, 63)}}}).error().code, ErrorCode::kShape);
  EXPECT_EQ(check_scenes({good, StillScene{{capture::EventImages(2, 64, 64)}}}).error().code, ErrorCode::kShape);
  EXPECT_EQ(check_scenes({good, StillScene{}}).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::calibrate
