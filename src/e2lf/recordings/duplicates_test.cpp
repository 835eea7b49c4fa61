// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "e2lf/recordings/event_counters.h"

namespace e2lf::recordings {
namespace {

EventColumns columns_of(const std::vector<Event>& events) {
  EventColumns columns;
  for (const Event& event : events) columns.push_back(event);
  return columns;
}

/// Returns random events in order of time, of which about 100 share each time.
std::vector<Event> random_events(size_t count) {
  std::mt19937 random(1);
  std::vector<Event> events(count);
  for (size_t i = 0; i < count; ++i) {
    events[i] = {.x = static_cast<uint16_t>(random() % 64),
                 .y = static_cast<uint16_t>(random() % 64),
                 .p = static_cast<uint8_t>(random() % 2),
                 .t = 1'000 + static_cast<int64_t>(i / 100)};
  }
  return events;
}

TEST(Duplicates, AreCountedAsASetCountsThem) {
  const std::vector<Event> events = random_events(100'000);
  std::set<std::tuple<uint16_t, uint16_t, uint8_t, int64_t>> seen;
  uint64_t expected = 0;
  for (const Event& event : events) expected += seen.insert({event.x, event.y, event.p, event.t}).second ? 0 : 1;
  DuplicateCounter counter;
  counter.add(columns_of(events));
  ASSERT_GT(expected, 500U);
  // The events of one time may share a slot, whose older event is then forgotten.
  EXPECT_LE(counter.duplicates(), expected);
  EXPECT_GE(counter.duplicates(), expected - expected / 100);
}

TEST(Duplicates, AreFoundAcrossBatchesAndDifferInNoField) {
  const Event event{.x = 7, .y = 9, .p = 1, .t = 50};
  Event other_x = event, other_y = event, other_p = event, later = event;
  other_x.x = 8, other_y.y = 8, other_p.p = 0, later.t = 51;
  DuplicateCounter counter;
  counter.add(columns_of({event, other_x, other_y, other_p}));
  EXPECT_EQ(counter.duplicates(), 0U);
  counter.add(columns_of({event, later}));
  EXPECT_EQ(counter.duplicates(), 1U);
  EXPECT_DOUBLE_EQ(counter.share(), 1.0 / 6.0);
}

TEST(Duplicates, OfHalfASensorAreTheShareThatIsDoubled) {
  DuplicateCounter counter;
  for (int64_t t = 0; t < 1000; ++t) {
    std::vector<Event> events;
    for (uint16_t x = 0; x < 346; x += 2) {
      events.push_back({.x = x, .y = static_cast<uint16_t>(t % 260), .p = 0, .t = t});
      if (x > 255) events.push_back(events.back());
    }
    counter.add(columns_of(events));
  }
  EXPECT_EQ(counter.duplicates(), 45'000U);  // x = 256, 258, ..., 344
  EXPECT_DOUBLE_EQ(counter.share(), 45.0 / 218.0);
}

TEST(Duplicates, NoEventsHaveAShareOfNone) {
  EXPECT_EQ(DuplicateCounter().share(), 0.0);
}

}  // namespace
}  // namespace e2lf::recordings
