// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// The reason why a word is implausible.
enum class WordFault {
  kUnknown,    ///< a type that does not exist
  kRange,      ///< a coordinate outside the sensor
  kTimeBack,   ///< a time before the last one
  kTimeAhead,  ///< a time far after the last one
};

enum class Verdict { kAccept, kReject, kNeedMore, kRestart };

/// Number of words by which the check is ahead of decoding: damage shows within a few words, and doubtful words are not
/// decoded.
inline constexpr size_t kHoldWords = 32;

/// Number of words that are inspected to determine whether the stream is aligned, and the smallest meaningful number.
inline constexpr size_t kWindowWords = 64;
inline constexpr size_t kMinWindowWords = 16;

/// Number of implausible words that a window may contain: to continue as before (isolated damage), and to resume the
/// stream.
inline constexpr size_t kWindowBad = kWindowWords / 16;
inline constexpr size_t kResumeBad = 1;

/// A longer run of zero words is not data (a simulator may well repeat the event of the first pixel).
inline constexpr uint32_t kMaxZeros = 7;

/// Number of words in which judge_time() looks for another time word.
inline constexpr size_t kJudgeWords = 8192;

/// Number of time words after an unexpected one that are considered.
inline constexpr size_t kJudges = 5;

/// In a stream with a heartbeat, a clock that jumps by more than a second across its wrap into its first second was
/// reset; data are rarely missing exactly there.
inline constexpr int64_t kWrapRestartUs = 1'000'000;

/// Determines whether a coarse time that decreases by at least `min_fall` steps is a restart of the clock. This
/// requires that three quarters of the following coarse times continue from it rather than from `last`. As many are
/// considered as the decrease has steps, but at least kJudges and at most kRestartWitnesses. time_at(i) returns the
/// coarse time of word i, if it has one; word 0 is the one in question, and `num_rejected` such words preceded it
/// directly. `mask` is the range of coarse times.
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
