// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/event_images.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::diagnose {
namespace {

using capture::EventImages;
using testing::ElementsAre;

std::vector<std::string> codes_in(const EventImages& images) {
  std::vector<std::string> found;
  for (const Finding& finding : check_event_images(images)) found.push_back(finding.code);
  return found;
}

/// Counts of both signs in all three images.
EventImages usual_images() {
  EventImages images(3, 40, 50);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(i % 7) - 3;
  return images;
}

TEST(CheckEventImages, UsualImagesRaiseNone) {
  EXPECT_TRUE(codes_in(usual_images()).empty());
}

TEST(CheckEventImages, A14ImagesWithoutEventsAreNamed) {
  const EventImages nothing(3, 40, 50);
  EXPECT_THAT(codes_in(nothing), ElementsAre("events-absent"));
  EventImages images = usual_images();
  std::ranges::fill(images.image(1), int16_t{0});
  EXPECT_THAT(codes_in(images), ElementsAre("event-image-empty"));
}

TEST(CheckEventImages, A14AlmostNoEventsAreCounted) {
  EventImages images(2, 40, 50);
  images.image(0)[3] = 1;
  images.image(1)[5] = -2;
  EXPECT_THAT(codes_in(images), ElementsAre("events-few"));
}

TEST(CheckEventImages, A14SaturatedPixelsAndALostSignAreNamed) {
  EventImages images(2, 40, 50);
  std::ranges::fill(images.values, int16_t{32767});
  EXPECT_THAT(codes_in(images), ElementsAre("counts-too-large", "sign-lost"));
  images = usual_images();
  for (int16_t& count : images.values) count = static_cast<int16_t>(-std::abs(count));
  EXPECT_THAT(codes_in(images), ElementsAre("sign-lost"));
}

}  // namespace
}  // namespace e2lf::diagnose
