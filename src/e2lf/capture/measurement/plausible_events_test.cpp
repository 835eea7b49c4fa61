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
  for (size_t i = 0; i < images.counts.size(); ++i) images.counts[i] = static_cast<int16_t>(i % 7) - 3;
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
  std::ranges::fill(images.counts, int16_t{32767});
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("most pixels of event images 0, 1"), HasSubstr("no OFF")));
  images = usual_images();
  for (int16_t& count : images.counts) count = static_cast<int16_t>(-std::abs(count));
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("no ON events")));
}

}  // namespace
}  // namespace e2lf::capture
