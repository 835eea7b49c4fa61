// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/decode_summary.h"
#include "e2lf/base/little_endian.h"

namespace e2lf::events {

// The three RAW encodings are sequences of words of one size whose meaning depends on words before them. RawStream
// decodes them all; an encoding is a `Codec` struct with static functions:
//
//   State            what decoding depends on           Check    what checking depends on; it runs ahead of decoding;
//                    its `heartbeat` is 0 or more where the stream repeats its time all along
//   check            how many words from here on are plausible; the one behind them, if any, needs a closer look
//   count_bad        how many words of a window make no sense (up to `enough`); low = well aligned. The sensor's size
//                    does not count: headers are known to be wrong about it
//   suspicion        what is odd about the word that check() stopped at
//   judge_time       whether a time word that steps unexpectedly is right, from the words behind it
//   accept_time, reject_time  moves the check past such a word
//   step_us          how far a coarse time word jumps from the last one; 0 for other words and for the next step
//   drop_word        the state when a word is left out
//   forget           the state when an unknown number of words is missing
//   go_on_from       makes the state that a stretch of words has brought about a guess at the one after `before` and
//                    all words up to there: the clock's loops, and what the stretch has not set
//   settle           goes over words without giving out events until the state is complete again
//   decode           checked words to events

/// What is odd about a word.
enum class Suspicion {
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

}  // namespace e2lf::events
