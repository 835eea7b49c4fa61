// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace e2lf::recordings {

/// What is odd about a word.
enum class WordFault {
  kUnknown,    ///< a type that does not exist
  kRange,      ///< a coordinate outside the sensor
  kTimeBack,   ///< a time before the last one
  kTimeAhead,  ///< a time far behind the last one
};

enum class Verdict { kAccept, kReject, kNeedMore };

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

/// So many unexpected time words in a row are a clock that was set anew.
inline constexpr uint32_t kClockRestart = 256;

}  // namespace e2lf::recordings
