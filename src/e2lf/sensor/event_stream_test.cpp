// SPDX-License-Identifier: MIT
#include "e2lf/sensor/event_stream.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/base/contract.h"
#include "e2lf/base/rng.h"

namespace e2lf::sensor {
namespace {

constexpr EventStreamOptions kOptions{.start_us = 1000, .pattern_us = 700, .settle_us = 500, .seed = 3};

std::vector<events::EventImages> random_cycles(size_t count) {
  std::vector<events::EventImages> cycles(count, events::EventImages(3, 11, 13));
  for (size_t c = 0; c < count; ++c) {
    const CounterRng rng(8, c);
    for (size_t i = 0; i < cycles[c].counts.size(); ++i) {
      cycles[c].counts[i] = static_cast<int16_t>(static_cast<int>(rng.below(i, 13)) - 4);
    }
  }
  return cycles;
}

/// Sums of the events between two times.
std::vector<int> accumulate(const events::EventColumns& events, int64_t begin_us, int64_t end_us) {
  std::vector<int> sums(11 * 13);
  for (size_t i = 0; i < events.size(); ++i) {
    if (events.t[i] < begin_us || events.t[i] >= end_us) continue;
    sums[size_t{events.y[i]} * 13 + events.x[i]] += events.p[i] != 0 ? 1 : -1;
  }
  return sums;
}

TEST(EventStream, AccumulatesToTheImagesItWasMadeFrom) {
  const auto cycles = random_cycles(2);
  const auto batch = event_stream(cycles, kOptions);
  for (size_t c = 0; c < 2; ++c) {
    std::vector<int> total(11 * 13);
    for (size_t n = 0; n <= 4; ++n) {
      const auto begin_us = static_cast<int64_t>(1000 + (4 * c + n) * 700);
      const auto sums = accumulate(batch.events, begin_us, begin_us + kOptions.settle_us);
      for (size_t i = 0; i < sums.size(); ++i) {
        if (n >= 1 && n <= 3) {
          ASSERT_EQ(sums[i], cycles[c].image(n - 1)[i]);
          total[i] += sums[i];
        }
        // The first pattern's return takes the cycle back.
        if (n == 4) {
          ASSERT_EQ(sums[i], -total[i]);
        }
      }
    }
  }
  size_t events = 0;
  for (size_t i = 0; i + 1 < batch.triggers.size(); ++i) {
    for (const int sum : accumulate(batch.events, batch.triggers[i].t, batch.triggers[i + 1].t)) {
      events += static_cast<size_t>(std::abs(sum));
    }
  }
  for (const int sum : accumulate(batch.events, batch.triggers.back().t, INT64_MAX)) {
    events += static_cast<size_t>(std::abs(sum));
  }
  EXPECT_EQ(events, batch.events.size());  // none outside, none that cancel
}

TEST(EventStream, IsSortedWithATriggerForEveryPattern) {
  const auto batch = event_stream(random_cycles(3), kOptions);
  EXPECT_TRUE(std::is_sorted(batch.events.t.begin(), batch.events.t.end()));
  ASSERT_EQ(batch.triggers.size(), 3U * 4 + 1);
  for (size_t i = 0; i < batch.triggers.size(); ++i) {
    EXPECT_EQ(batch.triggers[i], (events::Trigger{1000 + 700 * static_cast<int64_t>(i), 0, 1}));
  }
}

TEST(EventStream, EventsCrowdAtTheStartOfATransition) {
  std::vector<events::EventImages> cycles(1, events::EventImages(1, 100, 100));
  for (int16_t& count : cycles[0].counts) count = 5;
  const auto batch = event_stream(cycles, {.pattern_us = 1000, .settle_us = 1000});
  const auto early = std::count_if(batch.events.t.begin(), batch.events.t.end(), [](int64_t t) { return t < 1250; });
  EXPECT_NEAR(static_cast<double>(early), 25000, 500);  // a quarter of the time holds half of the events
}

TEST(EventStream, SeedMovesTimesOnly) {
  const auto cycles = random_cycles(1);
  auto other = kOptions;
  other.seed = 4;
  const auto a = event_stream(cycles, kOptions), b = event_stream(cycles, other);
  EXPECT_EQ(a, event_stream(cycles, kOptions));
  EXPECT_NE(a.events.t, b.events.t);
  EXPECT_EQ(a.events.size(), b.events.size());
  EXPECT_EQ(accumulate(a.events, 1700, 2200), accumulate(b.events, 1700, 2200));
}

TEST(EventStream, WrongInputsBreakTheContract) {
  EXPECT_THROW(std::ignore = event_stream({}), ContractError);
  auto cycles = random_cycles(2);
  EXPECT_THROW(std::ignore = event_stream(cycles, {.pattern_us = 100, .settle_us = 101}), ContractError);
  cycles[1] = events::EventImages(3, 11, 12);
  EXPECT_THROW(std::ignore = event_stream(cycles), ContractError);
}

}  // namespace
}  // namespace e2lf::sensor
