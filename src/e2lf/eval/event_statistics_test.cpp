// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/base/result.h"
#include "e2lf/eval/metrics.h"

namespace e2lf::eval {
namespace {

TEST(EventStatistics, CountsBothSignsInEachTransition) {
  capture::EventImages images(2, 2, 2);
  images.values = {3, -1, 0, 2, /**/ 0, 0, -2, 0};
  const EventStatistics statistics = event_statistics(images);
  EXPECT_EQ(statistics.events_per_pixel, (std::vector<double>{1.5, 0.5}));
  EXPECT_DOUBLE_EQ(statistics.total_events_per_pixel, 2.0);
}

TEST(EventStatistics, CountsTheExtremesOfInt16) {
  capture::EventImages images(1, 1, 2);
  images.values = {-32768, 32767};
  EXPECT_DOUBLE_EQ(event_statistics(images).total_events_per_pixel, 32767.5);
}

TEST(EventCost, GivesThePapersMeasurementTime) {
  // "If we need to acquire 7.18 events per pixel, the theoretical lower bound for the measurement time is 6.2 ms."
  EXPECT_NEAR(event_cost(7.18).min_measurement_ms, 6.2, 0.05);
}

TEST(EventCost, GivesThePapersDataRate) {
  // "7.175 events/pixel at the sensor ... 0.112 with respect to all the pixels of a light field ... 208 bits/pixel at
  // the sensor and 3.25 bits/pixel with respect to light field pixels."
  const EventStatistics cost = event_cost(7.175);
  EXPECT_NEAR(cost.bits_per_sensor_pixel, 208, 0.5);
  EXPECT_NEAR(cost.bits_per_light_field_pixel, 3.25, 0.005);
  EXPECT_NEAR(cost.events_per_light_field_pixel, 0.112, 0.0005);
}

TEST(EventStatistics, RefusesImagesWithoutPixels) {
  EXPECT_THROW((void)event_statistics(capture::EventImages()), ContractError);
}

}  // namespace
}  // namespace e2lf::eval
