// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "e2lf/recordings/restart.h"

namespace e2lf::recordings {

/// What is odd about a word.
enum class WordFault {
  kUnknown,    ///< a type that does not exist
  kRange,      ///< a coordinate outside the sensor
  kTimeBack,   ///< a time before the last one
  kTimeAhead,  ///< a time far behind the last one
};

enum class Verdict { kAccept, kReject, kNeedMore, kRestart };

/// Words the check is ahead of decoding: damage shows within a few words, and what is in doubt is not given out.
inline constexpr size_t kHoldWords = 32;

/// Words that are looked at to tell whether the stream is well aligned; fewer say too little.
inline constexpr size_t kWindowWords = 64;
inline constexpr size_t kMinWindowWords = 16;

/// How many odd words a window may have: to go on as before (isolated damage), and to take up the stream again.
inline constexpr size_t kWindowBad = kWindowWords / 16;
inline constexpr size_t kResumeBad = 1;

/// More words in a row that are all zero are no data (a simulator may well repeat the first pixel's event).
inline constexpr uint32_t kMaxZeros = 7;

/// How far judge_time() looks ahead for another time word.
inline constexpr size_t kJudgeWords = 8192;

/// How many of the time words behind an unexpected one are asked.
inline constexpr size_t kJudges = 5;

/// A clock that jumps over its wrap into its first second, by more than a second, was set anew, where the stream
/// repeats its time all along: data that is missing is rarely missing just there.
inline constexpr int64_t kWrapRestartUs = 1'000'000;

/// Whether a coarse time that steps back by at least `min_fall` begins a clock that starts again: three quarters of the
/// coarse times behind it go on from it rather than from `last`, of as many as the fall has steps, at least kJudges and
/// at most kRestartWitnesses. time_at(i): the coarse time of word i, if it has one; word 0 is the one in question, and
/// `num_rejected` such words came just before it. `mask` is the circle that coarse times run round.
template <typename TimeAt>
[[nodiscard]] Verdict judge_step_back(size_t count, bool ended, uint32_t last, uint32_t mask, uint32_t min_fall,
                                      size_t num_rejected, const TimeAt& time_at) {
  uint32_t chain = *time_at(0);
  const uint32_t fall = (last - chain) & mask;
  if (fall < min_fall) return Verdict::kReject;
  const size_t wanted = std::clamp<size_t>(fall, kJudges, kRestartWitnesses);
  const size_t seen = std::min(count, kJudgeWords);
  size_t asked = std::min<size_t>(num_rejected, wanted - 1), in_favour = asked;
  for (size_t i = 1; i < seen && asked < wanted; ++i) {
    const std::optional<uint32_t> following = time_at(i);
    if (!following) continue;
    ++asked;
    if (((*following - chain) & mask) >= ((*following - last) & mask)) continue;
    ++in_favour;
    chain = *following;
  }
  if (asked < wanted && count < kJudgeWords && !ended) return Verdict::kNeedMore;
  constexpr size_t kFewest = 3;
  return asked >= kFewest && 4 * in_favour >= 3 * asked ? Verdict::kRestart : Verdict::kReject;
}

}  // namespace e2lf::recordings
