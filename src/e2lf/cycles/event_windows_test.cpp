// SPDX-License-Identifier: MIT
#include "e2lf/cycles/event_windows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/base/progress.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::cycles {
namespace {

using recordings::EventBatch;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Hands out events and triggers in blocks of so many microseconds.
class Blocks final : public recordings::EventBlocks {
 public:
  Blocks(EventBatch all, int64_t block_us) : all_(std::move(all)), block_us_(block_us) {}

  Result<bool> next(EventBatch& block, recordings::DecodeSummary&) override {
    block.clear();
    while (block.empty()) {
      if (event_ == all_.events.size() && trigger_ == all_.triggers.size()) return false;
      now_us_ += block_us_;
      for (; event_ < all_.events.size() && all_.events.t[event_] < now_us_; ++event_) {
        block.events.push_back(all_.events[event_]);
      }
      for (; trigger_ < all_.triggers.size() && all_.triggers[trigger_].t < now_us_; ++trigger_) {
        block.triggers.push_back(all_.triggers[trigger_]);
      }
    }
    return true;
  }
  Result<void> seek_before(int64_t) override { return Error{ErrorCode::kUnsupported, "", ""}; }

 private:
  EventBatch all_;
  int64_t block_us_;
  int64_t now_us_ = 0;
  size_t event_ = 0, trigger_ = 0;
};

EventBatch events_at(const std::vector<int64_t>& times_us) {
  EventBatch batch;
  for (const int64_t t : times_us) batch.events.push_back({1, 2, 1, t});
  return batch;
}

struct Cut {
  std::vector<std::pair<int64_t, int64_t>> times;
  std::vector<std::vector<int64_t>> events;
  uint64_t outside = 0;
  std::string problem;
};

Cut cut(const EventBatch& all, const WindowOptions& options, int64_t block_us) {
  auto reader = std::make_unique<recordings::RecordingReader>(
      std::make_unique<Blocks>(all, block_us),
      recordings::RecordingInfo{.format = "test", .width = 4, .height = 4, .header = {}}, "test",
      recordings::OpenOptions());
  WindowReader windows(std::move(reader), options);
  Cut cut;
  for (EventWindow window;;) {
    const auto more = windows.next(window);
    if (!more) cut.problem = more.error().message;
    if (!more || !*more) break;
    cut.times.emplace_back(window.begin_us, window.end_us);
    cut.events.emplace_back(window.events.t.begin(), window.events.t.end());
  }
  cut.outside = windows.events_outside();
  return cut;
}

using Times = std::pair<int64_t, int64_t>;
using Events = std::vector<int64_t>;

TEST(EventWindows, OfTimeAreHalfOpenAndEmptyOnesCountToo) {
  const WindowOptions options{.kind = WindowKind::kTime, .duration_us = 10};
  for (const int64_t block_us : {1, 7, 1000}) {
    const Cut found = cut(events_at({105, 114, 115, 116, 137}), options, block_us);
    EXPECT_THAT(found.times, ElementsAre(Times{105, 115}, Times{115, 125}, Times{125, 135}, Times{135, 145}));
    EXPECT_THAT(found.events, ElementsAre(Events{105, 114}, Events{115, 116}, IsEmpty(), Events{137}));
  }
}

TEST(EventWindows, OfTimeBeginAtTheFirstTriggerOrWhereItIsSaid) {
  EventBatch all = events_at({105, 114});
  all.triggers.push_back({101, 0, 1});
  WindowOptions options{.kind = WindowKind::kTime, .duration_us = 10};
  for (const int64_t block_us : {1, 1000}) {
    options.origin_us.reset();
    EXPECT_THAT(cut(all, options, block_us).times, ElementsAre(Times{101, 111}, Times{111, 121}));
    options.origin_us = 90;
    EXPECT_THAT(cut(all, options, block_us).times, ElementsAre(Times{90, 100}, Times{100, 110}, Times{110, 120}));
  }
}

TEST(EventWindows, OfCountHaveSoManyEventsAndTheRestAtTheEnd) {
  const WindowOptions options{.kind = WindowKind::kCount, .events = 2};
  for (const int64_t block_us : {1, 3, 1000}) {
    const Cut found = cut(events_at({5, 6, 9, 9, 12}), options, block_us);
    EXPECT_THAT(found.events, ElementsAre(Events{5, 6}, Events{9, 9}, Events{12}));
    EXPECT_THAT(found.times, ElementsAre(Times{5, 7}, Times{9, 10}, Times{12, 13}));
  }
}

TEST(EventWindows, BetweenTriggersOfTheEdgeAndChannel) {
  EventBatch all = events_at({5, 10, 15, 20, 25, 30, 35});
  all.triggers = {{10, 0, 1}, {12, 0, 0}, {14, 1, 1}, {20, 0, 1}, {21, 0, 1}, {30, 0, 1}};
  WindowOptions options{.kind = WindowKind::kTriggers, .channel = 0};
  for (const int64_t block_us : {1, 4, 1000}) {
    const Cut found = cut(all, options, block_us);
    EXPECT_THAT(found.times, ElementsAre(Times{10, 20}, Times{20, 21}, Times{21, 30}));
    EXPECT_THAT(found.events, ElementsAre(Events{10, 15}, Events{20}, Events{25}));
    EXPECT_EQ(found.outside, 3U);
  }
}

TEST(EventWindows, RefuseWhatWouldTakeAllMemoryOrNeverEnd) {
  WindowOptions options{.kind = WindowKind::kTime, .duration_us = 10, .max_events = 3, .max_empty = 5};
  EXPECT_THAT(cut(events_at({1, 2, 3, 4}), options, 1000).problem, HasSubstr("more than 3 events"));
  EXPECT_THAT(cut(events_at({1, 200}), options, 1000).problem, HasSubstr("no event from 11 to 200 us"));
}

TEST(EventWindows, AStopLeavesOutTheWindowThatIsNotWhole) {
  const WindowOptions options{.kind = WindowKind::kTime, .duration_us = 10};
  auto reader = std::make_unique<recordings::RecordingReader>(
      std::make_unique<Blocks>(events_at({1, 12, 13}), 5),
      recordings::RecordingInfo{.format = "test", .width = 4, .height = 4, .header = {}}, "test",
      recordings::OpenOptions());
  WindowReader windows(std::move(reader), options);
  EventWindow window;
  ASSERT_TRUE(windows.next(window).value());
  request_stop(2);
  EXPECT_FALSE(windows.next(window).value());
  request_stop(0);
}

recordings::EventColumns column(const std::vector<recordings::Event>& events) {
  recordings::EventColumns columns;
  for (const recordings::Event& event : events) columns.push_back(event);
  return columns;
}

TEST(Voxelise, SharesAnEventBetweenTheTwoNearestBins) {
  // t* = 0, 1, 2.5 and 4.
  const auto grid = voxelise(column({{1, 0, 1, 100}, {0, 1, 0, 200}, {1, 1, 1, 350}, {0, 0, 1, 500}}), 5, 2, 2);
  capture::VoxelGrid expected(5, 2, 2);
  const auto at = [&](size_t bin, size_t y, size_t x) -> float& { return expected.values[(bin * 2 + y) * 2 + x]; };
  at(0, 0, 1) = 1.0F;
  at(1, 1, 0) = -1.0F;
  at(2, 1, 1) = 0.5F;
  at(3, 1, 1) = 0.5F;
  at(4, 0, 0) = 1.0F;
  EXPECT_EQ(grid, expected);
}

TEST(Voxelise, EventsOfOneTimeAreSpreadInTheirOrder) {
  const auto grid = voxelise(column({{0, 0, 1, 7}, {1, 0, 1, 7}, {2, 0, 0, 7}}), 5, 1, 3);
  EXPECT_EQ(grid.values[0], 1.0F);
  EXPECT_EQ(grid.values[2 * 3 + 1], 1.0F);
  EXPECT_EQ(grid.values[4 * 3 + 2], -1.0F);
  EXPECT_EQ(voxelise(column({{1, 0, 1, 7}}), 5, 1, 3).values[1], 1.0F);
}

TEST(Voxelise, TheBinsTogetherHoldTheSignedEvents) {
  recordings::EventColumns events;
  for (int i = 0; i < 1000; ++i) {
    events.push_back({static_cast<uint16_t>(i * 7 % 5), static_cast<uint16_t>(i % 3),
                      static_cast<uint8_t>(i * 3 % 4 / 2), int64_t{i} * i});
  }
  const auto grid = voxelise(events, 5, 3, 5);
  const auto counts = signed_counts(events, 3, 5);
  for (size_t pixel = 0; pixel < counts.size(); ++pixel) {
    float sum = 0.0F;
    for (size_t bin = 0; bin < 5; ++bin) sum += grid.values[bin * 15 + pixel];
    EXPECT_NEAR(sum, counts[pixel], 1e-3);
  }
}

TEST(Voxelise, NoEventsMakeAnEmptyGrid) {
  EXPECT_EQ(voxelise({}, 5, 2, 2), capture::VoxelGrid(5, 2, 2));
}

}  // namespace
}  // namespace e2lf::cycles
