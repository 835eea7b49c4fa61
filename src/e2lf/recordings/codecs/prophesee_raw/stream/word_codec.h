// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/stream/sinks.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_checks.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// One of the three RAW encodings: words of fixed size, whose meaning depends on earlier words. RawStream decodes all
/// of them through these static functions. `words` points to `count` words.
///
///   State            the state of decoding
///   Check            the state of the check, which runs ahead of decoding; its `heartbeat` is 0 or more if the stream
///                    repeats its time continually
///   check            returns the number of plausible words; the next one, if any, needs a closer look
///   count_bad        returns the number of invalid words, up to `enough`; few mean that the stream is aligned. Ignores
///                    the size of the sensor, because headers are known to be wrong about it
///   classify         returns what is implausible about the word at which check() stopped
///   judge_time       determines from the following words whether an unexpected time word is correct; kRestart if it
///                    steps back and most of them continue from it
///   num_padding      returns the number of words, from the one at which check() stopped, that only fill up a frame
///   accept_time, reject_time  advance the check past such a word
///   step_us          returns by how much a coarse time word jumps; 0 for other words and for the next step
///   is_near_zero     returns whether a coarse time word follows a wrap of the clock, in its first kWrapRestartUs
///   drop_word        updates the state when a word is dropped
///   forget           updates the state when an unknown number of words is missing
///   extrapolate      completes the state after a section of words to a guess of the state after `before` and all words
///                    up to there: the loops of the clock, and what the section has not set
///   resynchronise    skips words without returning events until the state is complete again
///   is_synchronised  returns whether the state is complete
///   decode           decodes checked words to events; returns the number of words used
///   skip_events      (optional) skips the words of a span of time and returns only their triggers
///   count_reports    (optional) sums the counts of the sensor in decoded words
///   time, time_loops return the time of the state in us, and how often the clock has wrapped around
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
