// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/plausible_events.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::capture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Counts of both signs in all three images.
EventImages usual_images() {
  EventImages images(3, 40, 50);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(i % 7) - 3;
  return images;
}

TEST(EventDoubts, UsualImagesRaiseNone) {
  EXPECT_TRUE(event_doubts(usual_images()).empty());
  EXPECT_FALSE(is_without_events(usual_images()));
}

TEST(EventDoubts, A14ImagesWithoutEventsAreNamed) {
  const EventImages nothing(3, 40, 50);
  EXPECT_TRUE(is_without_events(nothing));
  EXPECT_THAT(event_doubts(nothing), ElementsAre(HasSubstr("there are no events")));
  EventImages images = usual_images();
  std::ranges::fill(images.image(1), int16_t{0});
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("event image 1 holds no events")));
}

TEST(EventDoubts, A14AlmostNoEventsAreCounted) {
  EventImages images(2, 40, 50);
  images.image(0)[3] = 1;
  images.image(1)[5] = -2;
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("only 3 events on 50x40 px")));
}

TEST(EventDoubts, A14SaturatedPixelsAndALostSignAreNamed) {
  EventImages images(2, 40, 50);
  std::ranges::fill(images.values, int16_t{32767});
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("most pixels of event images 0, 1"), HasSubstr("no OFF")));
  images = usual_images();
  for (int16_t& count : images.values) count = static_cast<int16_t>(-std::abs(count));
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("no ON events")));
}

TEST(EventDoubts, B3InvertedPolarityAfterBlackIsNamed) {
  Codes codes(4, 1, 2);  // black, one cell, the other, both
  codes.pattern(1)[0] = codes.pattern(2)[1] = 1.0F;
  std::ranges::fill(codes.pattern(3), 1.0F);
  EventImages images = usual_images();
  for (int16_t& count : images.image(0)) count = static_cast<int16_t>(count + 2);  // mostly ON
  for (int16_t& count : images.image(2)) count = static_cast<int16_t>(count + 2);
  EXPECT_FALSE(is_polarity_inverted(images, codes));
  EXPECT_TRUE(event_doubts(images, &codes).empty());
  for (int16_t& count : images.values) count = static_cast<int16_t>(-count);
  EXPECT_TRUE(is_polarity_inverted(images, codes));
  EXPECT_THAT(event_doubts(images, &codes), ElementsAre(HasSubstr("polarity is inverted")));
  // Without the patterns, and with those of another cycle, nothing tells.
  EXPECT_TRUE(event_doubts(images).empty());
  EXPECT_FALSE(is_polarity_inverted(images, Codes(3, 1, 2)));
}

}  // namespace
}  // namespace e2lf::capture
