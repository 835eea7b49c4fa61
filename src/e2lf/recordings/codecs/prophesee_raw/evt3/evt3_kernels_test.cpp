// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <random>

#include "e2lf/base/isa.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"

namespace e2lf::recordings::evt3 {
namespace {

constexpr uint32_t kWidth = 200, kHeight = 60;

/// Words as sensors send them, and what they should not.
class WordMaker {
 public:
  explicit WordMaker(uint32_t seed) : random_(seed), shape_(seed % 4) {}

  std::vector<uint8_t> make(size_t count) {
    while (words_.size() < 2 * count) add_some();
    words_.resize(2 * count);
    return words_;
  }

 private:
  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }
  void put(uint32_t type, uint32_t payload) {
    const uint32_t word = type << 12 | payload;
    words_.push_back(static_cast<uint8_t>(word));
    words_.push_back(static_cast<uint8_t>(word >> 8));
  }
  uint32_t mask() { return below(4) == 0 ? 0 : static_cast<uint32_t>(random_() & random_() & 0xFFF); }

  void add_time() {
    const bool is_back = below(100) == 0;
    low_ = is_back ? low_ - std::min(low_, below(20)) : low_ + below(below(20) == 0 ? 150 : 18);
    if (low_ > 4095) {
      low_ = below(30);
      ++high_;
      put(kTimeHigh, high_);
    }
    put(kTimeLow, low_);
  }
  void add_vectors() {
    if (below(10) != 0) put(kVectBaseX, below(below(8) == 0 ? kWidth : kWidth - 40) | below(2) << 11);
    for (uint32_t triples = below(3); triples > 0; --triples) {
      put(kVect12, mask());
      put(kVect12, mask());
      put(kVect8, mask());
    }
    for (uint32_t alone = below(8) == 0 ? below(4) : 0; alone > 0; --alone) put(below(2) ? kVect12 : kVect8, mask());
  }
  /// Shape 0 is without vectors, 1 has few, 2 and 3 many; 3 has all that is rare.
  void add_some() {
    if (below(3) == 0) add_time();
    if (below(4) == 0) put(kTimeHigh, high_);
    if (below(3) == 0) put(kAddrY, below(kHeight) | below(2) << 11);
    for (uint32_t singles = below(shape_ > 1 ? 3 : 12); singles > 0; --singles) {
      put(kAddrX, below(kWidth) | below(2) << 11);
    }
    if (shape_ > 0 && below(shape_ == 1 ? 6 : 2) == 0) add_vectors();
    if (shape_ != 3) return;
    if (below(40) == 0) put(kTrigger, below(16) << 8 | below(2));
    if (below(20) == 0) put(kOthers, 0x14);
    if (below(20) == 0) put(kContinued12, below(4096));
    if (below(300) == 0) put(kVect8, mask());
  }

  std::mt19937 random_;
  uint32_t shape_;
  uint32_t high_ = 77, low_ = 0;
  std::vector<uint8_t> words_;
};

Evt3State known_state() {
  Evt3State state;
  state.high_us = int64_t{77} << 12;
  state.time_high = static_cast<uint16_t>(kTimeHigh << 12 | 77);
  state.need_time_high = false;
  return state;
}

struct Decoded {
  EventBatch batch;
  Evt3State state;
  bool operator==(const Decoded&) const = default;
};

template <typename Decode>
Decoded decode_columns(const std::vector<uint8_t>& words, const Decode& decode) {
  Decoded decoded;
  decoded.state = known_state();
  const size_t count = words.size() / 2;
  ColumnSink sink(decoded.batch, count * 12);
  EXPECT_EQ(decode(words.data(), count, decoded.state, SensorLimits{kWidth, kHeight}, sink), count);
  decoded.batch.events.resize(sink.count);
  return decoded;
}

TEST(Evt3Kernels, GiveWhatTheScalarReferenceGives) {
  const auto kernel = [](auto&&... arguments) { return Evt3WordCodec::decode(arguments...); };
  const auto reference = [](auto&&... arguments) { return Evt3WordCodec::decode_scalar(arguments...); };
  for (uint32_t seed = 0; seed < 120; ++seed) {
    const auto words = WordMaker(seed).make(seed % 3 == 0 ? 1 + seed : 3000 + seed);
    const Decoded columns = decode_columns(words, reference);
    for (const std::string& isa : available_isas()) {
      ASSERT_TRUE(set_max_isa(isa));
      ASSERT_EQ(decode_columns(words, kernel), columns) << isa << " " << seed;
    }
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST(Evt3Kernels, FindWhatTheScalarReferenceFinds) {
  for (uint32_t seed = 0; seed < 120; ++seed) {
    const auto words = WordMaker(seed).make(300 + seed);
    for (const std::string& isa : available_isas()) {
      ASSERT_TRUE(set_max_isa(isa));
      for (size_t at = 0; at < words.size() / 2; at += 1 + seed % 13) {
        const size_t count = words.size() / 2 - at;
        const uint16_t time_high = static_cast<uint16_t>(kTimeHigh << 12 | (77 + seed % 3));
        ASSERT_EQ(find_mark(&words[2 * at], count, time_high), find_mark_scalar(&words[2 * at], count, time_high));
        for (const TypeSet types : {only(kAddrY), only(kVectBaseX), only(kTimeLow), kVectors}) {
          ASSERT_EQ(find_last(words.data(), at, types), find_last_scalar(words.data(), at, types)) << isa;
        }
      }
    }
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST(Evt3Kernels, SkippedWordsLeaveTheStateAndTheTriggersOfDecodedOnes) {
  const SensorLimits limits{kWidth, kHeight};
  uint64_t num_skipped = 0;
  for (uint32_t seed = 0; seed < 120; ++seed) {
    const auto words = WordMaker(seed).make(20'000);
    const TimeSpan span = {(int64_t{77} << 12) + 500 * (seed % 9), (int64_t{77 + seed % 5} << 12) + 100};
    const Decoded whole =
        decode_columns(words, [](auto&&... arguments) { return Evt3WordCodec::decode_scalar(arguments...); });
    const Decoded part = decode_columns(
        words, [&](const uint8_t* at, size_t count, Evt3State& state, const SensorLimits&, ColumnSink& sink) {
          for (size_t used = 0; used < count;) {
            const size_t block = std::min<size_t>(count - used, 1 + seed * 17);
            const size_t skipped = Evt3WordCodec::skip_events(at + 2 * used, block, state, limits, span, sink);
            Evt3WordCodec::decode(at + 2 * (used + skipped), block - skipped, state, limits, sink);
            num_skipped += skipped;
            used += block;
          }
          return count;
        });
    Decoded expected = whole;
    expected.state.num_outside = part.state.num_outside;
    ASSERT_EQ(part.state, expected.state) << seed;
    ASSERT_EQ(part.batch.triggers.size(), whole.batch.triggers.size()) << seed;
    // What lies outside the span is there, in order.
    const auto& all = whole.batch.events;
    size_t i = 0;
    for (size_t k = 0; k < all.size(); ++k) {
      const bool is_same = i < part.batch.events.size() && part.batch.events.t[i] == all.t[k] &&
                           part.batch.events.x[i] == all.x[k] && part.batch.events.y[i] == all.y[k] &&
                           part.batch.events.p[i] == all.p[k];
      i += is_same ? 1 : 0;
      ASSERT_TRUE(is_same || (all.t[k] >= span.begin_us && all.t[k] < span.end_us)) << seed << " " << all.t[k];
    }
    ASSERT_EQ(i, part.batch.events.size()) << seed;
  }
  EXPECT_GT(num_skipped, 100'000U);
}

TEST(Evt3Kernels, CheckStopsWhereTheScalarReferenceStops) {
  for (uint32_t seed = 0; seed < 120; ++seed) {
    auto words = WordMaker(seed).make(2000 + seed);
    std::mt19937 random(seed);
    for (uint32_t damage = seed % 5; damage > 0; --damage)
      words[random() % words.size()] = random() % 3 == 0 ? 0 : 0xA5;
    for (const std::string& isa : available_isas()) {
      ASSERT_TRUE(set_max_isa(isa));
      Check check, expected;
      if (seed % 7 != 0) check.time_high = expected.time_high = known_state().time_high;
      for (size_t at = 0; at < words.size() / 2;) {
        const SensorLimits limits{kWidth, kHeight};
        const size_t count = words.size() / 2 - at;
        const size_t good = Evt3WordCodec::check(&words[2 * at], count, check, limits);
        ASSERT_EQ(good, check_scalar(&words[2 * at], count, expected, limits)) << isa << " " << seed << " " << at;
        ASSERT_EQ(check, expected) << isa << " " << seed << " " << at;
        at += good + 1;
        // What is odd is passed over, times are taken.
        if (at <= words.size() / 2 && words[2 * at - 1] >> 4 == kTimeHigh) {
          Evt3WordCodec::accept_time(&words[2 * at - 2], check);
          Evt3WordCodec::accept_time(&words[2 * at - 2], expected);
        }
      }
    }
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST(Evt3Kernels, CheckSeesTimesThatStepBackFromOneGroupToTheNext) {
  std::vector<uint8_t> words;
  for (int i = 0; i < 64; ++i) {
    const int low = i % 16 < 8 ? 1100 : 1020;
    const auto word = static_cast<uint16_t>((kTimeLow << 12) | static_cast<uint32_t>(low));
    words.push_back(static_cast<uint8_t>(word & 0xFF));
    words.push_back(static_cast<uint8_t>(word >> 8));
  }
  for (const std::string& isa : available_isas()) {
    ASSERT_TRUE(set_max_isa(isa));
    Check check, expected;
    check.time_high = expected.time_high = known_state().time_high;
    check.low = expected.low = 1000;
    const SensorLimits limits{kWidth, kHeight};
    const size_t good = Evt3WordCodec::check(words.data(), 64, check, limits);
    EXPECT_EQ(good, check_scalar(words.data(), 64, expected, limits)) << isa;
    EXPECT_EQ(check, expected) << isa;
    EXPECT_LT(good, 64U) << isa;
  }
  ASSERT_TRUE(set_max_isa(""));
}

}  // namespace
}  // namespace e2lf::recordings::evt3
