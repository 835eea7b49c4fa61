// SPDX-License-Identifier: MIT
#include "e2lf/streams/event_stream.h"

#include <gtest/gtest.h>

#include "testing/test_light.h"

namespace e2lf::streams {
namespace {

/// Everything that is random, at a size of more than one part.
StreamOptions noisy(StreamModel model) {
  using enum capture::PixelConstant;
  StreamOptions options = ideal_pixels();
  options.model = model;
  options.pixel[kReceptorRate] = 30.0F;
  options.pixel[kAmplifierRate] = 300.0F;
  options.pixel[kMismatch] = options.pixel[kNoise] = options.pixel[kDarkOff] = 0.1F;
  options.defects = {.refractory_us = 300, .leak_rate_hz = 3, .shot_rate_hz = 20, .hot_share = 0.01};
  options.v2e = v2e_preset("noisy").value();
  options.seed = 4;
  options.map_seed = 9;
  return options;
}

recordings::EventColumns events_of(const StreamOptions& options) {
  constexpr size_t kHeight = 90, kWidth = 100;
  TestLight light(options, kHeight, kWidth);
  std::vector<float> bright(kHeight * kWidth);
  for (size_t i = 0; i < bright.size(); ++i) bright[i] = static_cast<float>(i % 97) / 97.0F;
  light.show(0.0F, 5000);
  light.show(bright, 5000);
  light.ramp(0.3F, 0.05F, 7000);
  return light.events();
}

constexpr StreamModel kModels[] = {StreamModel::kQuantised, StreamModel::kReferenceAware, StreamModel::kEsim,
                                   StreamModel::kV2e, StreamModel::kPixel};

TEST(EventStream, IsTheSameForAnyNumberOfThreads) {
  const int threads = num_threads();
  for (const StreamModel model : kModels) {
    set_num_threads(1);
    const auto one = events_of(noisy(model));
    set_num_threads(3);
    const auto three = events_of(noisy(model));
    set_num_threads(threads);
    EXPECT_GT(one.size(), 10000U) << stream_model_name(model);
    EXPECT_TRUE(one == three) << stream_model_name(model);
  }
}

TEST(EventStream, ASeedIsACaptureAndAMapSeedASensor) {
  for (const StreamModel model : kModels) {
    auto options = noisy(model);
    const auto first = events_of(options);
    ++options.seed;
    EXPECT_FALSE(events_of(options) == first) << stream_model_name(model);
  }
  for (const StreamModel model : {StreamModel::kV2e, StreamModel::kPixel}) {
    auto options = noisy(model);
    const auto first = events_of(options);
    ++options.map_seed;
    EXPECT_FALSE(events_of(options) == first) << stream_model_name(model);
  }
}

TEST(EventStream, EventsComeInOrderOfTimeAndInTheirSegment) {
  for (const StreamModel model : kModels) {
    const auto events = events_of(noisy(model));
    EXPECT_TRUE(std::is_sorted(events.t.begin(), events.t.end())) << stream_model_name(model);
    EXPECT_GE(events.t.front(), 0);
    EXPECT_LT(events.t.back(), 17000);
  }
}

TEST(EventStream, LongSegmentsAreSortedToo) {
  auto options = noisy(StreamModel::kPixel);
  options.defects.hot_rate_hz = 20;
  TestLight light(options, 30, 30);
  light.show(0.2F, 3000000);
  EXPECT_GT(light.events().size(), 1000U);
  EXPECT_TRUE(std::is_sorted(light.events().t.begin(), light.events().t.end()));
}

TEST(EventStream, AReadoutLimitDelaysEventsAndLosesThoseThatWaitTooLong) {
  constexpr size_t kPixels = 1000;
  auto options = quiet(StreamModel::kReferenceAware);
  options.readout = {.events_per_s = 1e6, .longest_us = 400};
  TestLight light(options, 1, kPixels);
  light.show(0.0F, 1000);
  light.show(static_cast<float>(light_of_log(std::log(0.01) + 0.35)), 2000);  // an event of each pixel, at once
  ASSERT_EQ(light.events().size(), 401U);
  EXPECT_EQ(light.stream().lost_events(), kPixels - 401);
  for (size_t i = 0; i < light.events().size(); ++i) EXPECT_EQ(light.events().t[i], 1000 + static_cast<int64_t>(i));
}

TEST(EventStream, AReadoutLimitThatIsNotReachedChangesNothing) {
  auto options = noisy(StreamModel::kPixel);
  const auto free = events_of(options);
  options.readout.events_per_s = 1e12;
  EXPECT_TRUE(events_of(options) == free);
}

TEST(EventStream, RefusesWhatIsNoSensor) {
  EXPECT_EQ(EventStream::create({}, 0, 4).error().code, ErrorCode::kShape);
  EXPECT_EQ(EventStream::create({}, 4, 70000).error().code, ErrorCode::kShape);
  auto options = ideal_pixels();
  options.defects.refractory_us = -1;
  EXPECT_EQ(EventStream::create(options, 4, 4).error().code, ErrorCode::kInvalidValue);
  options = quiet(StreamModel::kEsim, 0.0F);
  EXPECT_EQ(EventStream::create(options, 4, 4).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(stream_model_from_name("nobodys").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(v2e_preset("nobodys").error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::streams
