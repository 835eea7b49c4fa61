// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/stream/sinks.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_checks.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// One of the three RAW encodings: words of one size whose meaning depends on words before them. RawStream decodes them
/// all through these static functions. `words` points to `count` words.
///
///   State            what decoding depends on
///   Check            what checking depends on, which runs ahead of decoding; its `heartbeat` is 0 or more where the
///                    stream repeats its time all along
///   check            how many words are plausible; the one behind them, if any, needs a closer look
///   count_bad        how many words make no sense, up to `enough`; few = well aligned. The sensor's size does not
///   count:
///                    headers are known to be wrong about it
///   classify         what is odd about the word that check() stopped at
///   judge_time       whether a time word that steps unexpectedly is right, from the words behind it; kRestart where
///                    it steps back and most of them go on from it
///   num_padding      how many of the words from the one that check() stopped at on fill a frame up, and mean nothing
///   accept_time, reject_time  moves the check past such a word
///   step_us          how far a coarse time word jumps from the last one; 0 for other words and for the next step
///   is_near_zero     whether a coarse time word lies behind a wrap of the clock, in its first kWrapRestartUs
///   drop_word        the state when a word is left out
///   forget           the state when an unknown number of words is missing
///   extrapolate      makes the state that a stretch of words has brought about a guess at the one after `before` and
///                    all words up to there: the clock's loops, and what the stretch has not set
///   resynchronise    goes over words without giving out events until the state is complete again
///   is_synchronised  whether the state is complete
///   decode           checked words to events; returns how many words were used
///   skip_events      (optional) goes over words of a span of time and gives out their triggers alone
///   count_reports    (optional) counts what the sensor reports of itself in decoded words
///   time, time_loops the state's time in us, and how often the clock has run round
template <typename C>
concept WordCodec = requires(const uint8_t* words, size_t count, typename C::State& state,
                             const typename C::State& before, typename C::Check& check,
                             const typename C::Check& checked, const SensorLimits& limits, DecodeSummary& summary,
                             ColumnSink& sink) {
  requires std::equality_comparable<typename C::State>;
  { C::kWordBytes } -> std::convertible_to<size_t>;
  { C::kMaxEventsPerWord } -> std::convertible_to<size_t>;
  { check.heartbeat } -> std::convertible_to<int64_t>;
  { C::check(words, count, check, limits) } -> std::same_as<size_t>;
  { C::count_bad(words, count, count) } -> std::same_as<size_t>;
  { C::classify(words, checked, limits) } -> std::same_as<WordFault>;
  { C::judge_time(words, count, true, checked) } -> std::same_as<Verdict>;
  { C::num_padding(words, count, checked) } -> std::same_as<size_t>;
  C::accept_time(words, check);
  C::reject_time(words, check);
  { C::is_near_zero(words, checked) } -> std::same_as<bool>;
  { C::step_us(words, checked) } -> std::same_as<int64_t>;
  C::drop_word(words, state);
  C::forget(state, check);
  C::extrapolate(state, before);
  { C::resynchronise(words, count, state, summary) } -> std::same_as<size_t>;
  { C::is_synchronised(before) } -> std::same_as<bool>;
  { C::decode(words, count, state, limits, sink) } -> std::same_as<size_t>;
  { C::time(before) } -> std::same_as<int64_t>;
  { C::time_loops(before) } -> std::same_as<uint64_t>;
};

}  // namespace e2lf::recordings
