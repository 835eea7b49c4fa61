// SPDX-License-Identifier: MIT
#include "e2lf/capture/plausible_events.h"

#include <gmock/gmock.h>

namespace e2lf::capture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Three images of 40x50 px: brighter, darker, brighter.
EventImages usual_images() {
  EventImages images(3, 40, 50);
  for (size_t transition = 0; transition < 3; ++transition) {
    for (int16_t& count : images.image(transition)) count = transition == 1 ? -1 : 2;
  }
  return images;
}

TEST(PlausibleEvents, UsualImagesRaiseNoDoubt) {
  EXPECT_FALSE(is_without_events(usual_images()));
  EXPECT_THAT(event_doubts(usual_images()), IsEmpty());
}

TEST(PlausibleEvents, ImagesOfZerosHaveNoEvents) {
  const EventImages images(3, 40, 50);
  EXPECT_TRUE(is_without_events(images));
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("no events")));
}

TEST(PlausibleEvents, NamesTheImageWithoutEvents) {
  auto images = usual_images();
  std::ranges::fill(images.image(2), int16_t{0});
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("event image 2 holds no events")));
}

TEST(PlausibleEvents, CountsThatNoPatternMakesAreNamed) {
  auto images = usual_images();
  std::ranges::fill(images.image(0), int16_t{255});
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("most pixels of event image 0 count 100 events or more")));
}

TEST(PlausibleEvents, OneSignAloneIsDoubtedBehindTheFirstTransition) {
  auto images = usual_images();
  for (int16_t& count : images.counts) count = static_cast<int16_t>(count < 0 ? -count : count);
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("ON events and no OFF")));
  EventImages first(1, 40, 50);
  std::ranges::fill(first.counts, int16_t{2});
  EXPECT_THAT(event_doubts(first), IsEmpty());
}

TEST(PlausibleEvents, AlmostNoEventsAreCounted) {
  EventImages images(2, 100, 100);
  images.image(0)[7] = 1;
  images.image(1)[9] = -2;
  EXPECT_THAT(event_doubts(images), ElementsAre(HasSubstr("only 3 events on 100x100 px")));
}

}  // namespace
}  // namespace e2lf::capture
