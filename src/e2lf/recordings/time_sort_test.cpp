// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "e2lf/base/text.h"
#include "e2lf/files/npy.h"
#include "e2lf/recordings/event_blocks.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

/// Events in blocks of 50, as they are.
class ListedBlocks final : public EventBlocks {
 public:
  explicit ListedBlocks(EventColumns events) : events_(std::move(events)) {}
  Result<bool> next(EventBatch& block, DecodeSummary&) override {
    block.clear();
    const size_t end = std::min(events_.size(), next_ + 50);
    block.events.append(events_, next_, end);
    return std::exchange(next_, end) < end;
  }
  Result<void> seek_before(int64_t) override {
    next_ = 0;
    return {};
  }

 private:
  EventColumns events_;
  size_t next_ = 0;
};

/// Events that differ in more than time, many of one time, in any order.
EventColumns shuffled(size_t count, uint32_t seed = 3) {
  EventColumns events = random_stream({.events = count, .max_gap_us = 1, .seed = seed}).events;
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  EventColumns mixed;
  for (const size_t i : order) mixed.push_back(events[i]);
  return mixed;
}

EventColumns in_order(const EventColumns& events) {
  std::vector<Event> list;
  for (size_t i = 0; i < events.size(); ++i) list.push_back(events[i]);
  std::stable_sort(list.begin(), list.end(), [](const Event& a, const Event& b) { return a.t < b.t; });
  EventColumns sorted;
  for (const Event& event : list) sorted.push_back(event);
  return sorted;
}

Result<EventColumns> read_blocks(EventBlocks& blocks, DecodeSummary& summary) {
  EventColumns all;
  EventBatch block;
  for (bool more = true; more;) {
    E2LF_ASSIGN_OR_RETURN(more, blocks.next(block, summary));
    all.append(block.events);
  }
  return all;
}

uint64_t late_events(const EventColumns& events) {
  uint64_t late = 0;
  int64_t latest_us = INT64_MIN;
  for (const int64_t t_us : events.t) {
    late += t_us < latest_us;
    latest_us = std::max(latest_us, t_us);
  }
  return late;
}

TEST(TimeSort, SortsInMemoryAndThroughAFile) {
  const EventColumns events = shuffled(3000);
  for (const size_t memory_events : {size_t{1}, size_t{120}, size_t{2999}, size_t{3000}, size_t{100'000}}) {
    const auto blocks = make_time_sorted(std::make_unique<ListedBlocks>(events), true, "list",
                                         {.memory_events = memory_events, .pipe_events = 1});
    for (int pass = 0; pass < 2; ++pass) {
      DecodeSummary summary;
      EXPECT_EQ(read_blocks(*blocks, summary).value(), in_order(events)) << memory_events;
      EXPECT_EQ(summary.out_of_order, late_events(events)) << memory_events;
      EXPECT_EQ(summary.num_violations(), 0u);
      ASSERT_TRUE(blocks->seek_before(INT64_MIN).ok());
    }
  }
}

TEST(TimeSort, HandsOnWhatIsInOrder) {
  const EventColumns events = in_order(shuffled(3000));
  for (const size_t memory_events : {size_t{100}, size_t{100'000}}) {
    const auto blocks = make_time_sorted(std::make_unique<ListedBlocks>(events), true, "list",
                                         {.memory_events = memory_events, .pipe_events = 1});
    DecodeSummary summary;
    EXPECT_EQ(read_blocks(*blocks, summary).value(), events);
    EXPECT_EQ(summary.out_of_order, 0u);
  }
}

TEST(TimeSort, SeeksAmongSortedEvents) {
  const EventColumns events = shuffled(3000), sorted = in_order(events);
  for (const size_t memory_events : {size_t{100}, size_t{100'000}}) {
    const auto blocks = make_time_sorted(std::make_unique<ListedBlocks>(events), true, "list",
                                         {.memory_events = memory_events, .pipe_events = 1});
    const int64_t t_us = sorted.t[1500];
    ASSERT_TRUE(blocks->seek_before(t_us).ok());
    DecodeSummary summary;
    const EventColumns rest = read_blocks(*blocks, summary).value();
    const auto expected = std::count_if(sorted.t.begin(), sorted.t.end(), [&](int64_t t) { return t >= t_us; });
    EXPECT_EQ(std::count_if(rest.t.begin(), rest.t.end(), [&](int64_t t) { return t >= t_us; }), expected);
  }
}

TEST(TimeSort, SortsAPipeAsFarAsItsEventsWait) {
  EventColumns events = in_order(shuffled(3000));
  for (size_t i = 0; i + 20 < events.size(); i += 20) {
    std::reverse(events.t.begin() + static_cast<ptrdiff_t>(i), events.t.begin() + static_cast<ptrdiff_t>(i + 20));
  }
  const auto sorted = make_time_sorted(std::make_unique<ListedBlocks>(events), false, "pipe", {.pipe_events = 30});
  DecodeSummary summary;
  EXPECT_EQ(read_blocks(*sorted, summary).value(), in_order(events));
  EXPECT_EQ(summary.out_of_order, late_events(events));

  const auto refused =
      make_time_sorted(std::make_unique<ListedBlocks>(shuffled(3000)), false, "pipe", {.pipe_events = 30});
  const auto read = read_blocks(*refused, summary);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(read.error().message.find("a file first"), std::string::npos);
}

std::vector<uint8_t> as_text(const EventColumns& events) {
  std::string text;
  for (size_t i = 0; i < events.size(); ++i) {
    text += cat(events.x[i], ",", events.y[i], ",", int{events.p[i]}, ",", events.t[i], "\n");
  }
  return {text.begin(), text.end()};
}

std::vector<uint8_t> as_npz(const EventColumns& events) {
  NpzArrays arrays;
  const auto put = [&](const char* key, const auto& column) {
    arrays.emplace(key, make_npy({column.size()}, std::span(std::as_const(column))));
  };
  put("x", events.x);
  put("y", events.y);
  put("p", events.p);
  put("t", events.t);
  return encode_npz(arrays);
}

TEST(TimeSort, NothingIsLostOfAShuffledRecording) {
  const EventColumns events = shuffled(20'000);
  for (const char* format : {"csv", "npz"}) {
    const std::vector<uint8_t> bytes = format == std::string("csv") ? as_text(events) : as_npz(events);
    OpenOptions options = {.format = format, .policy = DecodePolicy::kStrict};
    auto reader = open_recording(make_memory_source(std::span(bytes)), options).value();
    EXPECT_EQ(read_all(*reader)->events, in_order(events)) << format;
    EXPECT_EQ(reader->summary().out_of_order, late_events(events)) << format;
  }
}

TEST(TimeSort, ShuffledTextFromAPipeIsSorted) {
  const EventColumns events = shuffled(20'000);
  auto reader = open_recording(chunked(as_text(events), 1000), {.format = "csv"}).value();
  EXPECT_EQ(read_all(*reader)->events, in_order(events));
}

}  // namespace
}  // namespace e2lf::recordings
