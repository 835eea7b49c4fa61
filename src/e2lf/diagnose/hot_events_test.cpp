// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/hot_events.h"

#include <gtest/gtest.h>
#include <random>

namespace e2lf::diagnose {
namespace {

constexpr size_t kHeight = 40, kWidth = 50;

/// Returns events at random pixels, every twentieth of which is from one of five pixels if `has_hot`.
recordings::EventColumns random_events(size_t count, bool has_hot, uint32_t seed = 7) {
  std::mt19937 draw(seed);
  recordings::EventColumns events;
  events.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const size_t pixel = has_hot && i % 20 == 0 ? 401 * (draw() % 5) : draw() % (kHeight * kWidth);
    events.x[i] = static_cast<uint16_t>(pixel % kWidth);
    events.y[i] = static_cast<uint16_t>(pixel / kWidth);
  }
  return events;
}

size_t count_of(const recordings::EventColumns& events, size_t height = kHeight, size_t width = kWidth) {
  HotEvents hot(height, width);
  hot.add(events);
  return hot.count();
}

TEST(HotEvents, ArePixelsThatExceedTheirNeighboursAllTheTime) {
  EXPECT_EQ(count_of(random_events(40'000, true)), 5U);
  EXPECT_EQ(count_of(random_events(40'000, false)), 0U);
  HotEvents in_parts(kHeight, kWidth);
  for (uint32_t part = 0; part < 10; ++part) in_parts.add(random_events(1'999, true, part));
  EXPECT_EQ(in_parts.count(), 5U) << "batches that do not end with slices";
}

TEST(HotEvents, AreUnknownInShortRecordingsAndWithoutASize) {
  EXPECT_EQ(count_of(random_events(3 * 4'000 - 1, true)), 0U);
  EXPECT_EQ(count_of(random_events(3 * 4'000, true)), 5U);
  EXPECT_EQ(count_of(random_events(40'000, true), 0, 0), 0U);
  EXPECT_EQ(count_of(random_events(40'000, true), 65'536, 65'536), 0U) << "no 32 GB are allocated";
  EXPECT_EQ(count_of({}), 0U);
}

TEST(HotEvents, AreToldFromAShareOn) {
  EXPECT_FALSE(are_many_hot(3, 100));
  EXPECT_TRUE(are_many_hot(4, 100));
  EXPECT_FALSE(are_many_hot(299, 1'000'000));
  EXPECT_TRUE(are_many_hot(300, 1'000'000));
}

}  // namespace
}  // namespace e2lf::diagnose
