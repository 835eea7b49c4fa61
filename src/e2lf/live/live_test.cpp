// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <random>
#include <thread>

#include "e2lf/live/live_reader.h"
#include "e2lf/live/pace.h"
#include "e2lf/live/render.h"
#include "e2lf/live/session.h"
#include "e2lf/live/statistics.h"
#include "testing/test_streams.h"

namespace e2lf::live {
namespace {

using recordings::random_stream;
using recordings::TestFolder;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(NewestSlot, HoldsTheNewestValueAloneAndSaysWhatWasNeverTaken) {
  NewestSlot<int> slot;
  int value = 1;
  EXPECT_FALSE(slot.put(value));
  value = 2;
  EXPECT_TRUE(slot.put(value));
  EXPECT_EQ(value, 1) << "what was there comes back, so that its memory is used again";
  ASSERT_TRUE(slot.take(value));
  EXPECT_EQ(value, 2);
  value = 3;
  EXPECT_FALSE(slot.put(value));
  slot.close();
  ASSERT_TRUE(slot.take(value)) << "what lies in a closed slot can still be taken";
  EXPECT_EQ(value, 3);
  EXPECT_FALSE(slot.take(value));
}

TEST(Published, AWaitEndsWithTheWantedValueThePatienceOrTheEnd) {
  Published<int> values;
  const auto is_two = [](int value) { return value == 2; };
  EXPECT_EQ(values.wait(milliseconds(0), is_two), nullptr);
  values.put(std::make_shared<int>(1));
  EXPECT_EQ(values.wait(milliseconds(1), is_two), nullptr);
  EXPECT_EQ(*values.newest(), 1);
  std::thread writer([&] { values.put(std::make_shared<int>(2)); });
  EXPECT_EQ(*values.wait(seconds(60), is_two), 2);
  writer.join();
  values.close();
  EXPECT_EQ(values.wait(seconds(60), [](int value) { return value == 3; }), nullptr);
  EXPECT_EQ(*values.wait(seconds(60), is_two), 2) << "what is there can still be taken";
}

TEST(NewestSlot, EveryValueIsEitherTakenOrCountedAndTheyComeInOrder) {
  NewestSlot<int> slot;
  constexpr int kValues = 20'000;
  int skipped = 0;
  std::thread writer([&] {
    for (int i = 1; i <= kValues; ++i) {
      int value = i;
      skipped += slot.put(value) ? 1 : 0;
    }
    slot.close();
  });
  int taken = 0, last = 0, value = 0;
  while (slot.take(value)) {
    EXPECT_GT(value, last);
    last = value;
    ++taken;
  }
  writer.join();
  EXPECT_EQ(last, kValues);
  EXPECT_EQ(taken + skipped, kValues);
}

TEST(HalfSize, SumsBlocksOfTwoByTwoAndLeavesOutAnOddLastRowAndColumn) {
  capture::EventImages images(2, 3, 5);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(i);
  capture::EventImages half;
  sum_blocks(images, 2, half);
  EXPECT_EQ(half.height, 1u);
  EXPECT_EQ(half.width, 2u);
  const std::vector<int16_t> expected = {0 + 1 + 5 + 6, 2 + 3 + 7 + 8, 15 + 16 + 20 + 21, 17 + 18 + 22 + 23};
  EXPECT_EQ(half.values, expected);
  const int16_t* const memory = half.values.data();
  images.values.assign(images.values.size(), INT16_MIN);
  sum_blocks(images, 2, half);
  EXPECT_EQ(half.values.front(), INT16_MIN) << "sums are limited";
  EXPECT_EQ(half.values.data(), memory);
}

TEST(HalfSize, IsEnlargedByRepetition) {
  lightfield::LightField small({1, 1, 2, 2, 1});
  std::iota(small.data().begin(), small.data().end(), 1.0F);
  const std::vector<float> expected = {1, 1, 2, 2, 2, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 3, 3, 4, 4, 4};
  EXPECT_TRUE(std::ranges::equal(enlarged(small, 4, 5).data(), expected));
}

TEST(HalfSize, FusedCyclesBecomeMeansOverBlocksAndOfAsManyMoreCycles) {
  capture::FusedCycles fused{capture::EventImages(1, 3, 5), Planes<float>(1, 3, 5)};
  fused.counts.values = {64, 32, -64, -64, 9, 0, 34, -64, -67, 9, 9, 9, 9, 9, 9};
  fused.cycles.values = {1, 1, 8, 8, 9, 1, 1, 8, 2, 9, 9, 9, 9, 9, 9};
  capture::FusedCycles half;
  for (int again = 0; again < 2; ++again) {
    fuse_blocks(fused, 2, half);
    EXPECT_EQ(half.counts.values, (std::vector<int16_t>{33, -65}));  // 32.5 and -64.75
    ASSERT_EQ(half.cycles.values.size(), 2U);
    EXPECT_FLOAT_EQ(half.cycles.values[0], 4);
    EXPECT_FLOAT_EQ(half.cycles.values[1], 16 / (3 / 8.0F + 1 / 2.0F));
  }
}

TEST(CycleSum, SumsTheLastCyclesAndBeginsAnewWhenOneIsWanted) {
  CycleSum sum;
  const auto images = [](int16_t count) {
    capture::EventImages made(1, 1, 2);
    made.values = {count, static_cast<int16_t>(-count)};
    return made;
  };
  for (const auto& [added, wanted, cycles, expected] : std::vector<std::array<int, 4>>{{1, 1, 1, 1},
                                                                                       {2, 3, 1, 2},
                                                                                       {3, 3, 2, 5},
                                                                                       {4, 3, 3, 9},
                                                                                       {5, 3, 3, 12},
                                                                                       {6, 2, 2, 11},
                                                                                       {7, 1, 1, 7},
                                                                                       {8, 2, 1, 8}}) {
    capture::EventImages next = images(static_cast<int16_t>(added));
    EXPECT_EQ(sum.add(next, static_cast<size_t>(wanted)), static_cast<size_t>(cycles));
    EXPECT_EQ(next.values[0], expected);
    EXPECT_EQ(next.values[1], -expected);
  }
  capture::EventImages many = images(INT16_MAX), more = images(INT16_MAX);
  (void)sum.add(many, 2);
  (void)sum.add(more, 2);
  EXPECT_EQ(more.values[0], INT16_MAX) << "sums are limited, and do not wrap";
  EXPECT_EQ(more.values[1], INT16_MIN);
}

TEST(Pace, BeginsSmallGrowsWhileItKeepsPaceAndGoesBackWhenTheBetterOneWould) {
  const QualityLevel full{1, PictureSize::kFull}, half{1, PictureSize::kHalf}, quarter{1, PictureSize::kQuarter};
  Pace pace({50, 10});
  EXPECT_EQ(pace.level(), quarter);
  EXPECT_FALSE(pace.add(9.0, 0.1)) << "the first one prepares memory";
  EXPECT_TRUE(pace.add(0.03, 0.1)) << "four times that is tried";
  EXPECT_EQ(pace.level(), half);
  EXPECT_FALSE(pace.add(9.0, 0.1));
  EXPECT_FALSE(pace.add(0.05, 0.1)) << "four times that is no pace";
  EXPECT_TRUE(pace.add(0.4, 0.1));
  EXPECT_EQ(pace.level(), quarter);
  int added = 0;
  for (; !pace.add(0.01, 0.1); ++added) ASSERT_LT(added, 100);
  EXPECT_GT(added, 10) << "after a step that was too slow, the next one is not tried at once";
  EXPECT_EQ(pace.level(), half);
  Pace fast({50, 10});
  for (int i = 0; i < 4; ++i) fast.add(0.01, 0.1);
  EXPECT_EQ(fast.level(), full);
  for (int i = 0; i < 2; ++i) fast.add(0.01, 0.1);
  EXPECT_EQ(fast.level(), (QualityLevel{0, PictureSize::kFull})) << "five times that is a pace, too";
}

TEST(Pace, KeepsANamedSizeAndAPaceThatHolds) {
  Pace named({1}, PictureSize::kFull), keeps({1}, PictureSize::kFull);
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(named.add(5, 0.1));
    EXPECT_FALSE(keeps.add(0.09, 0.1));
    EXPECT_FALSE(keeps.add(0.2, 0)) << "nothing is known of the cycle";
  }
  EXPECT_EQ(keeps.level().size, PictureSize::kFull);
  Pace better({50, 10}, PictureSize::kHalf);
  for (int i = 0; i < 50; ++i) better.add(0.01, 0.1);
  EXPECT_EQ(better.level(), (QualityLevel{0, PictureSize::kHalf}));
  EXPECT_FALSE(choice_of("auto", kPictureSizes).value().has_value());
  EXPECT_EQ(choice_of("half", kPictureSizes).value(), PictureSize::kHalf);
  EXPECT_FALSE(choice_of("Half", kPictureSizes).ok());
}

/// A source whose cycles are read and reconstructed one after another on one processor, in simulated time.
struct SimulatedSource {
  static constexpr double kCycleS = 0.1;
  double read_s = 0.03, quarter_s = 0.01;  // per cycle, and per light field of a quarter of the size
  double now_s = 0;
  LateCycles late = {};
  Pace pace{{1}};
  size_t shown = 0, dropped = 0;

  /// Returns the latency of cycle `number` when it is shown, or nothing if it is dropped.
  std::optional<double> take(int number) {
    const double end_s = kCycleS * number;
    now_s = std::max(now_s, end_s) + read_s;
    if (late.drops(now_s - end_s, number == 0 ? 0 : kCycleS)) {
      ++dropped;
      return std::nullopt;
    }
    ++shown;
    const bool is_late = now_s - end_s > LateCycles::most_s(kCycleS);
    const auto side = static_cast<double>(block_side(pace.level().size));
    const double field_s = quarter_s * 16 / (side * side);
    now_s += field_s;
    (void)pace.add(field_s, kCycleS, is_late);
    return now_s - end_s;
  }
};

TEST(LateCycles, AreDroppedAfterTheStartUntilTheLatencyIsBelowTwoCycles) {
  SimulatedSource source{.now_s = 1.4};  // the reading begins late
  EXPECT_TRUE(source.take(0)) << "there is a picture at once";
  // Each cycle that is dropped takes 0.07 s of the latency.
  for (int number = 1; number <= 9; ++number) EXPECT_FALSE(source.take(number)) << number;
  EXPECT_NEAR(source.take(10).value(), 1.44 - 10 * 0.1 + 10 * 0.03 + 0.01, 1e-9) << "one of ten is shown";
  EXPECT_EQ(source.pace.level().size, PictureSize::kQuarter);
  int number = 11;
  while (!source.take(number)) ASSERT_LT(++number, 30);
  EXPECT_EQ(number, 18) << "0.75 s - 8 * 0.07 s is below 0.2 s";
  const size_t dropped = source.dropped;
  double worst = 0;
  for (int i = 1; i <= 40; ++i) {
    const auto latency = source.take(number + i);
    if (latency && i > 8) worst = std::max(worst, *latency);
  }
  // Half the size takes 0.04 s; the full one, 0.16 s, would be no pace.
  EXPECT_EQ(source.pace.level().size, PictureSize::kHalf);
  EXPECT_LT(worst, 0.2);
  EXPECT_EQ(source.dropped, dropped) << "nothing more is late";
}

TEST(LateCycles, OneOfTenIsShownOfASourceThatIsAlwaysLate) {
  SimulatedSource source{.read_s = 0.12};
  for (int number = 0; number < 500; ++number) (void)source.take(number);
  EXPECT_NEAR(static_cast<double>(source.shown), 50, 10);
  EXPECT_EQ(source.pace.level().size, PictureSize::kQuarter);
  LateCycles late;
  EXPECT_FALSE(late.drops(9, 0)) << "nothing is known of the cycle";
  EXPECT_FALSE(late.drops(0.04, 0.001)) << "short cycles wait for their transfer";
  EXPECT_TRUE(late.drops(0.06, 0.001));
}

TEST(Pace, ShrinksIfCyclesAreLateAndGrowsAgainHoweverOftenThatWas) {
  Pace pace({1});
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(pace.add(0.001, 0.1, true)) << "it is as small as it can be";
  for (int lag = 0; lag < 10; ++lag) {
    for (int i = 0; i < 100; ++i) (void)pace.add(0.001, 0.1);
    EXPECT_EQ(pace.level().size, PictureSize::kFull) << lag;
    EXPECT_TRUE(pace.add(0.001, 0.1, true));
    EXPECT_EQ(pace.level().size, PictureSize::kHalf) << lag;
  }
}

TEST(RecentQuantiles, AreExactAndForgetWhatIsOld) {
  RecentQuantiles values;
  EXPECT_EQ(values.at(0.5), 0);
  for (int i = 10; i >= 1; --i) values.add(i);
  EXPECT_EQ(values.at(0.5), 5);
  EXPECT_EQ(values.at(0.9), 9);
  EXPECT_EQ(values.at(1), 10);
  for (size_t i = 0; i < RecentQuantiles::kKept; ++i) values.add(100);
  EXPECT_EQ(values.at(0), 100);
}

TEST(ArrivalClock, TakesTheLeastDelayAndFollowsDrift) {
  ArrivalClock clock;
  const Clock::time_point begin{seconds(100)};
  clock.add(begin + milliseconds(10), 0);
  clock.add(begin + milliseconds(103), 100'000);  // 3 ms late
  clock.add(begin + milliseconds(290), 200'000);  // waited for 90 ms
  EXPECT_EQ(clock.arrival_of(150'000), begin + milliseconds(153));
  // The sensor's clock loses 1 ms each second.
  for (int i = 1; i <= 60; ++i) clock.add(begin + milliseconds(1001 * i + 3), 1'000'000LL * i);
  const auto late = clock.arrival_of(60'000'000) - (begin + milliseconds(60'063));
  EXPECT_LE(late, milliseconds(0));
  EXPECT_GE(late, milliseconds(-11)) << "the drift of two windows";
}

TEST(ArrivalClock, FollowsAReplayAtAnotherSpeed) {
  ArrivalClock clock(0.2);
  const Clock::time_point begin{seconds(100)};
  for (int i = 0; i <= 60; ++i) clock.add(begin + seconds(i), 200'000LL * i);
  EXPECT_EQ(clock.arrival_of(12'000'000), begin + seconds(60));
}

recordings::EventBatch batch_of(int64_t begin_us, size_t events, size_t on) {
  recordings::EventBatch batch;
  for (size_t i = 0; i < events; ++i) {
    batch.events.push_back({static_cast<uint16_t>(i % 8), 1, static_cast<uint8_t>(i < on ? 1 : 0), begin_us});
  }
  return batch;
}

TEST(Statistics, CountsAndGivesRatesOfTheLastSecond) {
  const Clock::time_point begin{seconds(10)};
  Statistics statistics(begin);
  recordings::EventBatch batch = batch_of(5'000, 1000, 250);
  batch.triggers = {{5'000, 3, 1}, {5'100, 3, 0}, {5'200, 7, 1}};
  statistics.add_batch(batch, begin + milliseconds(100));
  statistics.add_batch(batch_of(1'005'000, 1000, 750), begin + milliseconds(500));
  statistics.add_batch(batch_of(2'005'000, 10, 0), begin + milliseconds(2000));
  statistics.add_cycle(0.5F);
  statistics.add_cycle(0.75F);
  statistics.add_skipped();
  statistics.add_skipped(Skipped::kLate);
  statistics.add_field(0.2, 0.1, PictureSize::kHalf);
  Json json = statistics.json(begin + milliseconds(2500));
  EXPECT_EQ(json["events"], 2010);
  EXPECT_EQ(json["cycles"], 2);
  EXPECT_EQ(json["fields"], 1);
  EXPECT_EQ(json["skipped_cycles"], 2);
  EXPECT_EQ(json["late_cycles"], 1);
  EXPECT_EQ(json["fields_of_size"], (Json{{"half", 1}}));
  EXPECT_EQ(json["latency_s"]["p90"], 0.2);
  EXPECT_EQ(json["least_confidence"], 0.5);
  EXPECT_EQ(json["recorded_s"], 2.0);
  EXPECT_EQ(json["events_per_s"], 1000.0) << "2000 in the two seconds before the last batch";
  EXPECT_EQ(json["on_share"], 0.5);
  EXPECT_EQ(json["triggers"]["3"], 1) << "rising edges alone";
  EXPECT_EQ(json["triggers_per_s"]["7"], 0.5);
  json = statistics.json(begin + milliseconds(12'000));
  EXPECT_EQ(json["events_per_s"], 1.0) << "nothing came since";
}

TEST(Statistics, DamagedTriggersDoNotFillTheMemory) {
  Statistics statistics;
  recordings::EventBatch batch;
  for (int id = 0; id < 65536; ++id) batch.triggers.push_back({1, static_cast<uint16_t>(id), 1});
  statistics.add_batch(batch);
  EXPECT_LE(statistics.json()["triggers"].size(), 64u);
}

LiveField demo_field() {
  LiveField field;
  field.light_field = lightfield::LightField({8, 8, 24, 32});
  size_t i = 0;
  for (float& value : field.light_field.data()) value = static_cast<float>(++i * 7919 % 1000) / 1000;
  field.serial = 1;
  return field;
}

TEST(LiveField, IsCompleteOnlyIfTheOtherViewsWereMade) {
  LiveField field;
  field.views = {3, 4};
  const auto fails = [](LiveField& all) {
    EXPECT_TRUE(all.views.empty());
    return Result<void>(Error{ErrorCode::kInternal, "", ""});
  };
  EXPECT_FALSE(field.complete(fails).ok());
  EXPECT_EQ(field.views, (std::vector<size_t>{3, 4}));
  EXPECT_TRUE(field.complete([](LiveField&) { return Result<void>(); }).ok());
  EXPECT_TRUE(field.views.empty());
}

TEST(RenderSettings, AViewpointOfTheGridIsThatViewPixelForPixel) {
  LiveField field = demo_field();
  field.black = 0.125F;
  field.gain = 1.5F;
  const Picture picture = render(field, {.x = -1.5F, .y = 2.5F, .row = 10, .column = 1'000'000});
  lightfield::Image view(32, 24, 1);
  const auto pixels = field.light_field.view(6, 2);
  for (size_t i = 0; i < pixels.size(); ++i) view.pixels[i] = 1.5F * (pixels[i] - 0.125F);
  EXPECT_EQ(picture.image, lightfield::to_bytes(view));
  EXPECT_EQ(picture.row_epi.width, 32u);
  EXPECT_EQ(picture.row_epi.height, 8u);
  EXPECT_EQ(picture.row_epi.pixels[2 * 32 + 7], picture.image.pixels[10 * 32 + 7]) << "row 10 of view 2";
  EXPECT_EQ(picture.column_epi.width, 8u);
  EXPECT_EQ(picture.column_epi.pixels[6], picture.image.pixels[31]) << "a column outside is the last one";
}

TEST(RenderSettings, AWideApertureIsTheRefocusedSum) {
  const LiveField field = demo_field();
  const Picture picture = render(field, {.x = 0, .y = 0, .focus = 1.25F, .radius = 3});
  const auto aperture = lightfield::round_aperture(field.light_field.shape(), {.radius = 3});
  EXPECT_EQ(picture.image, lightfield::to_bytes(lightfield::refocus(field.light_field, 1.25F, aperture)));
  LiveField half = demo_field();
  half.level.size = PictureSize::kHalf;
  EXPECT_EQ(render(half, {.x = 0, .y = 0, .focus = 2.5F, .radius = 3}).image, picture.image)
      << "disparities are those of the full size";
}

TEST(RenderSettings, TheFocusOfAPointIsTheDisparityOfWhatIsSeenThere) {
  constexpr float kDisparity = 1.3F;
  LiveField field;
  field.light_field = lightfield::LightField({8, 8, 48, 64});
  for (size_t view = 0; view < 64; ++view) {
    for (size_t y = 0; y < 48; ++y) {
      for (size_t x = 0; x < 64; ++x) {
        const float to_x = static_cast<float>(x) - kDisparity * (static_cast<float>(view % 8) - 3.5F);
        const float to_y = static_cast<float>(y) - kDisparity * (static_cast<float>(view / 8) - 3.5F);
        field.light_field.at(view / 8, view % 8, y, x) = 0.5F + 0.25F * std::sin(to_x) + 0.25F * std::sin(1.3F * to_y);
      }
    }
  }
  EXPECT_NEAR(disparity_at(field, 30.5F, 20), kDisparity, 0.02F);
  field.level.size = PictureSize::kHalf;
  EXPECT_NEAR(disparity_at(field, 61, 40), 2 * kDisparity, 0.04F) << "of the full size";
}

TEST(RenderSettings, NumbersOfNobodyAreHarmless) {
  const LiveField field = demo_field();
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
  for (const RenderSettings& settings :
       {RenderSettings{nan, nan, nan, nan, {}, {}}, RenderSettings{huge, -huge, huge, huge, {}, {}},
        RenderSettings{-huge, huge, -huge, -huge, {}, {}}}) {
    EXPECT_EQ(render(field, settings).image.pixels.size(), 32u * 24u);
    EXPECT_LE(std::abs(disparity_at(field, settings.x, settings.y)), 5.1F);
  }
}

TEST(EventPreview, MakesPicturesOnlyWhereTheyAreAskedFor) {
  EventPreview preview(8, 4);
  preview.add(batch_of(0, 8, 4));
  const Clock::time_point now{seconds(50)};
  EXPECT_FALSE(preview.take(now).has_value());
  preview.add(batch_of(100'000, 8, 4));
  EXPECT_FALSE(preview.take(now).has_value()) << "its time has not passed";
  preview.add(batch_of(100'000 + EventPreview::kWindowUs, 8, 8));
  const auto picture = preview.take(now);
  ASSERT_TRUE(picture.has_value());
  EXPECT_EQ(picture->events, 8u);
  EXPECT_EQ(picture->image.pixels[0], 128) << "row 0 has no events";
  EXPECT_EQ(picture->image.pixels[8], 255);
  EXPECT_EQ(picture->image.pixels[8 + 7], 1);
  preview.add(batch_of(200'000, 8, 4));
  preview.add(batch_of(300'000, 8, 4));
  EXPECT_FALSE(preview.take(now + seconds(60)).has_value()) << "an old picture shows nothing of now";
}

TEST(EventPreview, SharpnessFallsWithBlurAndNotWithTheRateOrNoise) {
  constexpr size_t kWidth = 200, kHeight = 100;
  std::mt19937 random(7);
  // Stripes of 10 px; each pixel has independent noise, here less than Poisson noise.
  const auto stripes = [&](int blur, int rate) {
    std::normal_distribution<double> noise(0, 0.3 * std::sqrt(rate));
    std::vector<int16_t> counts;
    for (size_t i = 0; i < kWidth * kHeight; ++i) {
      int lit = 0;
      for (int k = -blur; k <= blur; ++k) lit += (i % kWidth + 20 + static_cast<size_t>(k + 4)) % 20 < 10 ? 1 : -1;
      counts.push_back(static_cast<int16_t>(std::lround(1.0 * rate * lit / (2 * blur + 1) + noise(random))));
    }
    return sharpness_of(counts, kWidth, static_cast<uint64_t>(rate) * kWidth * kHeight);
  };
  EXPECT_GT(stripes(0, 100), 2 * stripes(1, 100));
  EXPECT_GT(stripes(1, 100), 1.5 * stripes(3, 100));
  EXPECT_NEAR(stripes(1, 50) / stripes(1, 800), 1, 0.1);
  std::vector<int16_t> noise(kWidth * kHeight);
  for (int16_t& count : noise) count = static_cast<int16_t>(random() % 21) - 10;
  // Squares of the differences would give 3; their products are random and average out in larger pictures.
  EXPECT_LT(sharpness_of(noise, kWidth, 5 * noise.size()), 0.06);
  EXPECT_EQ(sharpness_of(std::vector<int16_t>(100, 7), 10, 700), 0);
  EXPECT_EQ(sharpness_of(std::vector<int16_t>(100, 0), 10, 0), 0);
  EXPECT_EQ(sharpness_of(std::vector<int16_t>{1, 2, 3}, 3, 6), 0) << "a single row";
}

TEST(EventPreview, PassesOnTheSharpnessOfTheWholeCycle) {
  EventPreview preview(8, 4);
  capture::EventImages images(2, 4, 8);
  for (size_t y = 0; y < 4; ++y) {
    for (size_t x = 4; x < 8; ++x) images.values[y * 8 + x] = 1;  // an edge; the second image has no events
  }
  const std::span<const int16_t> edge(images.values.data(), 32);
  EXPECT_DOUBLE_EQ(sharpness_of(images), sharpness_of(edge, 8, 16));
  const Clock::time_point now = Clock::now();
  EXPECT_FALSE(preview.take(now).has_value());
  preview.add_cycle(7, images);
  preview.add(batch_of(100'000, 8, 4));
  preview.add(batch_of(100'000 + EventPreview::kWindowUs, 8, 8));
  const auto picture = preview.take(now);
  ASSERT_TRUE(picture && picture->cycle);
  EXPECT_EQ(picture->cycle->number, 7u);
  EXPECT_DOUBLE_EQ(picture->cycle->sharpness, sharpness_of(images));
}

TEST(Recorder, WritesWhatCameBetweenOnAndOffAndNeverReplacesAFile) {
  const TestFolder folder;
  const recordings::RecordingInfo info{.format = "dat", .width = 64, .height = 48, .header = {{"key", "value"}}};
  Recorder recorder(folder / ".", info);
  const recordings::EventBatch stream =
      random_stream({.events = 3000, .width = 64, .height = 48, .trigger_every = 100});
  recorder.write(stream);
  EXPECT_EQ(recorder.json()["bytes"], 0);
  ASSERT_TRUE(recorder.begin().ok());
  recorder.write(stream);
  EXPECT_EQ(recorder.json()["is_recording"], true);
  ASSERT_TRUE(recorder.end().ok());
  recorder.write(stream);
  const std::filesystem::path file = recorder.json()["file"].get<std::string>();
  EXPECT_EQ(std::filesystem::file_size(file), recorder.json()["bytes"].get<uint64_t>());
  const auto reader = recordings::open_recording(file).value();
  EXPECT_EQ(reader->info().find("key"), "value");
  EXPECT_EQ(recordings::read_all(*reader).value(), stream);
  Recorder again(folder / ".", info);
  ASSERT_TRUE(again.begin().ok());
  EXPECT_NE(again.json()["file"], recorder.json()["file"]);
  EXPECT_FALSE(Recorder({}, info).begin().ok()) << "no folder";
}

}  // namespace
}  // namespace e2lf::live
