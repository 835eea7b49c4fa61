// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "testing/chunked_source.h"
#include "testing/damage.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

constexpr int64_t kMaxLossUs = 1000;
constexpr size_t kMaxMadeUp = 250;  ///< events that are wrong: what comes before a wrong time or row shows (128 us)

/// A busy recording of some milliseconds with triggers, in one encoding.
struct Recording {
  EventBatch batch;
  std::vector<uint8_t> bytes;
  size_t header_bytes = 0;
};

Recording make_recording(const std::string& format, uint32_t seed) {
  std::mt19937 random(seed);
  Recording recording;
  int64_t t_us = 16'770'000;  // the 24-bit clock wraps on the way
  for (size_t i = 0; i < 3000; ++i) {
    t_us += random() % 8;
    const auto y = static_cast<uint16_t>(random() % 480);
    const auto p = static_cast<uint8_t>(random() & 1);
    auto x = static_cast<uint16_t>(random() % 600);
    const size_t run = random() % 4 == 0 ? 8 : 1;
    for (size_t k = 0; k < run; ++k, x = static_cast<uint16_t>(x + 1 + random() % 3)) {
      recording.batch.events.push_back({x, y, p, t_us});
    }
    if (i % 300 == 0) recording.batch.triggers.push_back({t_us, 1, static_cast<uint8_t>(i / 300 & 1)});
  }
  recording.bytes = encoded(recording.batch, format);
  recording.header_bytes = parse_raw_header(recording.bytes, true, "").value().num_bytes;
  return recording;
}

EventBatch read_bytes(std::span<const uint8_t> bytes) {
  return decoded(bytes).batch;
}

/// How many events the first `size` bytes hold.
size_t events_in(const Recording& recording, size_t size) {
  return read_bytes(std::span(recording.bytes).first(std::min(size, recording.bytes.size()))).events.size();
}

/// Compares what is left with what was there: the same events in front of and behind one stretch.
void expect_local(const EventBatch& left, const Recording& recording, const DamagedPlace& place) {
  const EventColumns& before = recording.batch.events;
  const EventColumns& after = left.events;
  ASSERT_TRUE(std::is_sorted(after.t.begin(), after.t.end()));
  size_t front = 0, back = 0;
  const size_t shorter = std::min(before.size(), after.size());
  while (front < shorter && before[front] == after[front]) ++front;
  while (back < shorter - front && before[before.size() - 1 - back] == after[after.size() - 1 - back]) ++back;
  EXPECT_LE(after.size() - front - back, kMaxMadeUp);
  if (front + back >= before.size()) return;

  const int64_t first_lost_us = before.t[front];
  const int64_t last_lost_us = before.t[before.size() - 1 - back];
  const size_t first_touched = std::min(events_in(recording, place.begin), before.size() - 1);
  const size_t last_touched = std::min(events_in(recording, place.begin + place.size), before.size() - 1);
  EXPECT_LT(before.t[first_touched] - first_lost_us, kMaxLossUs) << "lost before the damage";
  EXPECT_LT(last_lost_us - before.t[last_touched], kMaxLossUs) << "lost behind the damage";

  // Triggers outside the stretch are all there, and there are no others to speak of.
  size_t false_triggers = left.triggers.size();
  for (const Trigger& trigger : recording.batch.triggers) {
    const bool there = std::find(left.triggers.begin(), left.triggers.end(), trigger) != left.triggers.end();
    if (there) --false_triggers;
    const bool near_damage = trigger.t >= first_lost_us - kMaxLossUs && trigger.t <= last_lost_us + kMaxLossUs;
    EXPECT_TRUE(there || near_damage) << trigger.t;
  }
  EXPECT_LE(false_triggers, 8u);
}

class Damaged : public testing::TestWithParam<std::tuple<const char*, int>> {
 protected:
  const char* format_ = std::get<0>(GetParam());
  Damage kind_ = static_cast<Damage>(std::get<1>(GetParam()));
};

TEST_P(Damaged, OnlyWhatIsNearTheDamageIsLost) {
  const Recording recording = make_recording(format_, 7);
  ASSERT_EQ(read_bytes(recording.bytes), recording.batch);
  const char* rounds = std::getenv("E2LF_DAMAGE_ROUNDS");  // more than a test has time for
  const int trials = 150 * (rounds != nullptr ? std::max(std::atoi(rounds), 1) : 1);
  std::mt19937 random(static_cast<uint32_t>(std::get<1>(GetParam())));
  for (int trial = 0; trial < trials; ++trial) {
    SCOPED_TRACE(trial);
    auto bytes = recording.bytes;
    const size_t max_size = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 9 : 300;
    const DamagedPlace place = damage(bytes, recording.header_bytes + 64, kind_, max_size, random);
    expect_local(read_bytes(bytes), recording, place);
    if (HasFailure()) {
      ADD_FAILURE() << format_ << ": byte " << place.begin << ", " << place.size << " touched";
      return;
    }
  }
}

TEST_P(Damaged, EveryPathGivesTheSame) {
  const Recording recording = make_recording(format_, 8);
  std::mt19937 random(static_cast<uint32_t>(std::get<1>(GetParam())) + 100);
  for (int trial = 0; trial < 20; ++trial) {
    auto bytes = recording.bytes;
    for (int i = 0; i < 3; ++i) damage(bytes, recording.header_bytes, kind_, 20, random);
    ASSERT_TRUE(set_max_isa("scalar"));
    const EventBatch expected = read_bytes(bytes);
    ASSERT_TRUE(set_max_isa(""));
    EXPECT_EQ(read_bytes(bytes), expected) << trial;
    const size_t cut = random() % bytes.size();
    EXPECT_EQ(decoded(std::make_unique<ChunkedSource>(bytes, std::vector<size_t>{cut}, bytes.size())).batch, expected);
    EXPECT_EQ(decoded(chunked(bytes, 1 + random() % 500)).batch, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Raw, Damaged,
                         testing::Combine(testing::Values("evt2", "evt2.1", "evt3"), testing::Range(0, kNumDamages)),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

TEST(Noise, HasNextToNoEventsAndTriggers) {
  std::mt19937 random(5);
  for (const std::string format : {"evt2", "evt2.1", "evt3"}) {
    std::vector<uint8_t> bytes(300'000);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    const Decoded noise = decoded(bytes, {.format = format, .width = 640, .height = 480});
    EXPECT_LT(noise.batch.events.size(), 100u) << format;
    EXPECT_LT(noise.batch.triggers.size(), 10u) << format;
    EXPECT_GT(noise.summary.of(Violation::kMisaligned).count, 0u);
  }
}

TEST(ZerosAtTheEnd, OfAnInterruptedCopyAreCountedAndCostNoEvent) {
  for (const std::string format : {"evt2", "evt2.1", "evt3"}) {
    const size_t word_bytes = format == "evt3" ? 2 : format == "evt2" ? 4 : 8;
    const Recording recording = make_recording(format, 7);
    // Few bytes at a time only for the short tail, because the reader looks at all of it again each time.
    for (const auto& [zeros, step] :
         std::vector<std::pair<size_t, size_t>>{{100, 5}, {100, 1000}, {40'000, 5000}, {40'000, 1 << 20}}) {
      std::vector<uint8_t> bytes = recording.bytes;
      bytes.resize(bytes.size() + zeros * word_bytes);
      const Decoded read = decoded(chunked(bytes, step));
      EXPECT_EQ(read.batch, recording.batch) << format;
      EXPECT_EQ(read.summary.of(Violation::kZeros), (ViolationCount{zeros, recording.bytes.size()})) << format;
      EXPECT_EQ(read.summary.num_violations(), zeros) << format;
    }
  }
}

/// Zeros that begin within a word, as copies end at a multiple of bytes of the disk and not of the words.
TEST(ZerosAtTheEnd, ThatBeginWithinAWordAreCounted) {
  for (const std::string format : {"evt2", "evt2.1", "evt3"}) {
    const size_t word_bytes = format == "evt3" ? 2 : format == "evt2" ? 4 : 8;
    const Recording recording = make_recording(format, 7);
    const size_t middle = recording.bytes.size() / 2;
    for (size_t begin = middle; begin < middle + 40; ++begin) {
      std::vector<uint8_t> bytes = recording.bytes;
      std::fill(bytes.begin() + static_cast<ptrdiff_t>(begin), bytes.end(), 0);
      const Decoded read = decoded(bytes);
      const size_t zeros = (bytes.size() - begin) / word_bytes;
      EXPECT_NEAR(read.summary.of(Violation::kZeros).count, zeros, 1) << format << ", byte " << begin;
      EXPECT_LE(read.summary.num_violations(), zeros + 3) << format << ", byte " << begin;
    }
  }
}

TEST(ClockSetAnew, GoesOnAfterAWhile) {
  // The second half begins earlier than the first ends, as when two recordings are joined.
  Recording recording = make_recording("evt3", 9);
  std::vector<uint8_t> twice = recording.bytes;
  twice.insert(twice.end(), recording.bytes.begin() + static_cast<ptrdiff_t>(recording.header_bytes),
               recording.bytes.end());
  const EventBatch batch = read_bytes(twice);
  EXPECT_TRUE(std::is_sorted(batch.events.t.begin(), batch.events.t.end()));
  EXPECT_GT(batch.events.size(), recording.batch.events.size() * 5 / 4);
}

}  // namespace
}  // namespace e2lf::recordings
