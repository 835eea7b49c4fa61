// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/metavision_hdf5/ecf.h"

#include <gtest/gtest.h>
#include <random>

#include "e2lf/recordings/event.h"
#include "testing/test_streams.h"

namespace e2lf::recordings::ecf {
namespace {

std::vector<uint8_t> encode(const EventColumns& events) {
  std::vector<uint8_t> bytes(max_encoded_size(events.size()));
  bytes.resize(ecf::encode({events.x, events.y, events.p, events.t}, bytes));
  return bytes;
}

Result<EventColumns> decode(const std::vector<uint8_t>& bytes) {
  E2LF_ASSIGN_OR_RETURN(const size_t count, event_count(bytes));
  EventColumns events;
  events.resize(count);
  E2LF_RETURN_IF_ERROR(ecf::decode(bytes, {events.x, events.y, events.p, events.t}));
  return events;
}

/// A second decoder, written from the format's description alone: one value at a time, no shared code.
class PlainDecoder {
 public:
  explicit PlainDecoder(const std::vector<uint8_t>& bytes) : bytes_(bytes) {}

  EventColumns decode() {
    const uint64_t header = take(4);
    const size_t n = header >> 2;
    EventColumns out;
    int64_t now = static_cast<int64_t>(take(8));
    for (int64_t gap = 0, scale = 1; out.t.size() < n;) {
      const uint64_t byte = take(1);
      if (byte / 16 == 15) {
        gap += static_cast<int64_t>(byte % 16) * scale;
        scale *= 16;
        continue;
      }
      now += gap + static_cast<int64_t>(byte / 16);
      gap = 0;
      scale = 1;
      const uint64_t count = byte % 16 == 15 ? take(2) : byte % 16;
      out.t.insert(out.t.end(), count, now);
    }
    if (header & 2) {
      for (const uint64_t v : take_quads(n, 4)) {
        out.y.push_back(static_cast<uint16_t>(v / 4096));
        out.x.push_back(static_cast<uint16_t>(v / 2 % 2048));
        out.p.push_back(v % 2);
      }
      return out;
    }
    while (out.y.size() < n) {
      const uint64_t word = take(2);
      out.y.insert(out.y.end(), word % 32 == 31 ? take(2) : word % 32, static_cast<uint16_t>(word / 32));
    }
    if (header & 1) {
      for (const uint64_t v : take_quads(n, 2)) {
        out.x.push_back(static_cast<uint16_t>(v / 2));
        out.p.push_back(v % 2);
      }
      return out;
    }
    while (out.x.size() < n) {
      const uint64_t word = take(2);
      out.x.push_back(static_cast<uint16_t>(word / 32));
      for (int i = 0; i < 5; ++i) {
        if (word % 32 & (16 >> i)) out.x.push_back(static_cast<uint16_t>(word / 32 + i + 1));
      }
    }
    while (out.p.size() < n) {
      const uint64_t byte = take(1);
      out.p.insert(out.p.end(), byte % 128 == 127 ? take(2) : byte % 128, byte / 128);
    }
    return out;
  }

 private:
  uint64_t take(size_t count) {
    uint64_t value = 0;
    for (size_t i = 0; i < count; ++i) value |= static_cast<uint64_t>(bytes_.at(next_++)) << (8 * i);
    return value;
  }
  /// Four values as the bits of three words of `width` bytes: each value's low bits follow those of the one before.
  std::vector<uint64_t> take_quads(size_t count, size_t width) {
    std::vector<uint64_t> values;
    const uint64_t q = width * 2;  // bits in a quarter of a word
    for (size_t i = 0; i < count; i += 4) {
      const uint64_t a = take(width), b = take(width), c = take(width);
      values.push_back(a >> q);
      values.push_back((a % (1u << q)) + ((b >> 2 * q) << q));
      values.push_back((b % (1u << 2 * q)) + ((c >> 3 * q) << 2 * q));
      values.push_back(c % (uint64_t{1} << 3 * q));
    }
    values.resize(count);
    return values;
  }

  const std::vector<uint8_t>& bytes_;
  size_t next_ = 0;
};

EventColumns rows_of_neighbours(size_t count) {
  EventColumns events;
  for (size_t i = 0; i < count; ++i) {
    events.push_back({static_cast<uint16_t>(i % 640), static_cast<uint16_t>(i / 640), i / 3000 % 2 == 0,
                      static_cast<int64_t>(1000 + i / 64)});
  }
  return events;
}

TEST(Ecf, SmallChunkHasTheBytesOfTheFormat) {
  EventColumns events;
  events.push_back({3, 5, 1, 100});
  events.push_back({4, 5, 1, 100});
  events.push_back({7, 5, 1, 130});
  // One row, one group (mask: +1 and +4), one run of p; 30 us = 0x1E: digits E and 1, then a run of one.
  const std::vector<uint8_t> expected = {
      12, 0, 0, 0, 100, 0, 0, 0, 0, 0, 0, 0, 0x02, 0xFE, 0xF1, 0x01, 5 << 5 | 3, 0, 3 << 5 | 16 | 2, 0, 128 | 3};
  EXPECT_EQ(encode(events), expected);
}

TEST(Ecf, EveryLayoutComesBackFromBothDecoders) {
  EventColumns dense_rows;  // one row, scattered x: packed x and p
  std::mt19937 random(7);
  for (int i = 0; i < 999; ++i) dense_rows.push_back({static_cast<uint16_t>(random() % 2048), 2047, i % 2 == 0, i / 9});
  const EventColumns scattered =
      random_stream({.events = 1001, .width = 2048, .height = 2048, .max_gap_us = 90}).events;
  const std::vector<std::pair<EventColumns, int>> cases = {
      {rows_of_neighbours(5000), 0}, {dense_rows, 1}, {scattered, 2}};
  for (const auto& [events, layout] : cases) {
    const std::vector<uint8_t> bytes = encode(events);
    EXPECT_EQ(bytes[0] & 3, layout);
    auto decoded = decode(bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.error().text();
    EXPECT_EQ(*decoded, events);
    EXPECT_EQ(PlainDecoder(bytes).decode(), events);
  }
}

TEST(Ecf, LengthsAroundQuadsAndRunEscapesComeBack) {
  for (const size_t count : {1, 2, 3, 4, 5, 14, 15, 16, 30, 31, 32, 126, 127, 128, 65534, 65535}) {
    EventColumns same;
    for (size_t i = 0; i < count; ++i) same.push_back({9, 9, 1, 55});
    EventColumns mixed = random_stream({.events = count, .width = 33, .height = 3, .max_gap_us = 20}).events;
    for (const EventColumns& events : {same, mixed}) {
      auto decoded = decode(encode(events));
      ASSERT_TRUE(decoded.ok()) << count;
      EXPECT_EQ(*decoded, events) << count;
      EXPECT_EQ(PlainDecoder(encode(events)).decode(), events) << count;
    }
  }
}

TEST(Ecf, LongGapsComeBack) {
  EventColumns events;
  for (const int64_t t :
       std::initializer_list<int64_t>{0, 14, 29, 45, 300, 70000, int64_t{1} << 40, (int64_t{1} << 62) - 1}) {
    events.push_back({1, 2, 0, t});
  }
  auto decoded = decode(encode(events));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, events);
}

TEST(Ecf, WhatItCannotHoldIsSaid) {
  const auto holds = [](std::initializer_list<Event> list) {
    EventColumns events;
    for (const Event& event : list) events.push_back(event);
    return can_encode({events.x, events.y, events.p, events.t});
  };
  EXPECT_TRUE(holds({{2047, 2047, 1, 0}}));
  EXPECT_FALSE(holds({}));
  EXPECT_FALSE(holds({{2048, 0, 0, 0}}));
  EXPECT_FALSE(holds({{0, 2048, 0, 0}}));
  EXPECT_FALSE(holds({{0, 0, 2, 0}}));
  EXPECT_FALSE(holds({{0, 0, 0, -1}}));
  EXPECT_FALSE(holds({{0, 0, 0, 5}, {0, 0, 0, 4}}));
}

TEST(Ecf, EveryTruncationIsRefused) {
  for (const EventColumns& events :
       {rows_of_neighbours(200), random_stream({.events = 50, .width = 1280, .height = 720}).events}) {
    const std::vector<uint8_t> bytes = encode(events);
    for (size_t length = 0; length < bytes.size(); ++length) {
      EXPECT_FALSE(decode({bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(length)}).ok()) << length;
    }
  }
}

/// Decodes a chunk and drops its zeros.
EventColumns without_zeros(const std::vector<uint8_t>& bytes) {
  EventColumns events = decode(bytes).value();
  const size_t kept = drop_zeros(bytes, {events.x, events.y, events.p, events.t});
  events.resize(kept);
  return events;
}

TEST(Ecf, ZerosInPlaceOfHalfTheEventsLeaveTheOtherHalf) {
  constexpr size_t kEvents = 16384, kHalf = kEvents / 2, kBytesOfHalf = kHalf / 4 * 12;
  EventColumns events = random_stream({.events = kEvents, .width = 640, .height = 480, .max_gap_us = 9}).events;
  events.x[kHalf - 1] = events.x[kHalf] = 7;  // not zero, so that the halves are exact
  const std::vector<uint8_t> good = encode(events);
  ASSERT_EQ(good[0] & 3, 2) << "places are packed";
  EXPECT_EQ(without_zeros(good), events) << "a chunk without damage";
  const size_t places = good.size() - 2 * kBytesOfHalf;
  for (const size_t lost : {size_t{0}, kHalf}) {
    std::vector<uint8_t> damaged = good;
    std::fill_n(damaged.begin() + static_cast<ptrdiff_t>(places + lost / 4 * 12), kBytesOfHalf, uint8_t{0});
    EventColumns expected;
    for (size_t i = 0; i < kHalf; ++i) expected.push_back(events[kHalf - lost + i]);
    EXPECT_EQ(without_zeros(damaged), expected) << "zeros from event " << lost << " on";
  }
  std::vector<uint8_t> without_places = good;
  std::fill(without_places.begin() + static_cast<ptrdiff_t>(places), without_places.end(), uint8_t{0});
  EXPECT_EQ(without_zeros(without_places).size(), 0u);
}

TEST(Ecf, ZerosInPlaceOfTimesAreRefused) {
  std::vector<uint8_t> bytes = encode(random_stream({.events = 4000, .width = 640, .height = 480}).events);
  std::fill(bytes.begin() + 100, bytes.end(), uint8_t{0});
  EXPECT_FALSE(decode(bytes).ok());
}

TEST(Ecf, EventsOfTheFirstPixelAreNotTakenForZeros) {
  EventColumns hot;
  for (int i = 0; i < 4000; ++i) {
    const int place = i % 3 == 0 ? 0 : i;
    hot.push_back({static_cast<uint16_t>(place * 37 % 640), static_cast<uint16_t>(place * 11 % 480),
                   static_cast<uint8_t>(i % 2), 10 * i});
  }
  EXPECT_EQ(without_zeros(encode(hot)), hot);
}

TEST(Ecf, DamagedChunksNeverBreakTheColumns) {
  std::mt19937 random(3);
  const std::vector<uint8_t> good = encode(rows_of_neighbours(700));
  size_t refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<uint8_t> bytes = good;
    for (int i = 0; i < 1 + trial % 8; ++i) bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
    auto decoded = decode(bytes);
    refused += !decoded.ok();
    if (decoded.ok()) {
      EXPECT_TRUE(std::is_sorted(decoded->t.begin(), decoded->t.end()));
    }
  }
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace e2lf::recordings::ecf
