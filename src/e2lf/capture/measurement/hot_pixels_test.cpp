// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/hot_pixels.h"

#include <gtest/gtest.h>
#include <set>

#include "e2lf/base/rng.h"

namespace e2lf::capture {
namespace {

constexpr size_t kSide = 128, kTransitions = 3;

/// A cycle of a scene of squares of 16 px with different mean counts, from -6 to 8, and noise of one event.
EventImages noisy_scene(uint64_t cycle) {
  EventImages images(kTransitions, kSide, kSide);
  for (size_t i = 0; i < images.values.size(); ++i) {
    const size_t y = i / kSide % kSide / 16, x = i % kSide / 16, n = i / images.image_size();
    const auto mean = static_cast<int>((5 * y + 3 * x + 7 * n) % 15) - 6;
    images.values[i] = static_cast<int16_t>(mean + static_cast<int>(CounterRng(1, cycle).below(i, 3)) - 1);
  }
  return images;
}

std::set<size_t> drawn_pixels(size_t number) {
  std::set<size_t> pixels;
  for (uint64_t i = 0; pixels.size() < number; ++i) pixels.insert(CounterRng(2, 0).below(i, kSide * kSide));
  return pixels;
}

TEST(HotPixels, AreFoundAtOnceAndNoOthers) {
  const std::set<size_t> hot = drawn_pixels(kSide * kSide / 100);
  constexpr HotLimits kLimits{.beyond_range = 0.75F, .in_single_cycle = 2};
  CountSums healthy, defective;
  for (uint64_t cycle = 0; cycle < 20; ++cycle) {
    EventImages images = noisy_scene(cycle);
    healthy.add(images);
    for (size_t n = 0; n < kTransitions; ++n) {
      for (const size_t p : hot) images.image(n)[p] = static_cast<int16_t>(images.image(n)[p] + 15);
    }
    defective.add(images);
    if (cycle == 10) defective.fade();
    EXPECT_EQ(hot_pixels(healthy, kLimits), std::vector<size_t>()) << "cycle " << cycle;
    size_t found = 0;
    for (const size_t p : hot_pixels(defective, kLimits)) {
      EXPECT_TRUE(hot.contains(p)) << "cycle " << cycle << ", pixel " << p;
      ++found;
    }
    EXPECT_GE(found, hot.size() * 95 / 100) << "cycle " << cycle;
  }
}

TEST(HotPixels, ExceedTheNoiseOfASingleCycle) {
  EventImages images(kTransitions, kSide, kSide);
  for (size_t n = 0; n < kTransitions; ++n) {
    images.image(n)[1000] = 2;  // as one of some thousand pixels with the noise of the paper's event model
    images.image(n)[3000] = 3;
  }
  CountSums sums;
  sums.add(images);
  EXPECT_EQ(hot_pixels(sums), std::vector<size_t>{3000});
}

TEST(HotPixels, DarkOrDeadOnesAreNotHot) {
  EventImages images(1, kSide, kSide);
  std::ranges::fill(images.values, int16_t{9});
  images.values[1000] = 0;
  CountSums sums;
  sums.add(images);
  EXPECT_EQ(hot_pixels(sums), std::vector<size_t>());
}

TEST(SilentPixels, HaveNoEventsAmongNeighboursThatHaveSome) {
  EventImages images(2, kSide, kSide);
  std::ranges::fill(images.image(0), int16_t{9});
  images.image(0)[0] = images.image(0)[1000] = images.image(0)[1001] = 0;
  images.image(1)[1001] = -1;  // it has an event
  CountSums sums;
  sums.add(images);
  sums.add(images);
  EXPECT_EQ(count_silent_pixels(sums), 0U);  // 18 events per neighbour are too few to tell
  sums.add(images);
  EXPECT_EQ(count_silent_pixels(sums), 2U);
}

TEST(HotPixels, GetTheMedianOfTheirNeighbours) {
  EventImages images(2, 8, 8);
  std::ranges::fill(images.image(0), int16_t{2});
  std::ranges::fill(images.image(1), int16_t{-5});
  const EventImages right = images;
  // Neighbours of each other, and a corner.
  for (const size_t p : {0, 27, 28}) images.image(0)[p] = images.image(1)[p] = 40;
  CountSums sums;
  sums.add(images);
  EXPECT_EQ(hot_pixels(sums), (std::vector<size_t>{0, 27, 28}));
  replace_by_neighbours({0, 27, 28}, images);
  EXPECT_EQ(images, right);
}

}  // namespace
}  // namespace e2lf::capture
