// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_codec.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// Bytes of a RAW recording, of which those before `position` are done.
template <size_t kWordBytes>
struct WordInput {
  static constexpr size_t kNoStop = SIZE_MAX;

  std::span<const uint8_t> bytes;
  size_t position;
  size_t stop;          ///< no word may reach beyond this
  bool ended;           ///< no bytes follow
  uint64_t first_byte;  ///< position of bytes[0] in the file
  DecodeSummary* summary;

  [[nodiscard]] const uint8_t* data() const { return bytes.data() + position; }
  [[nodiscard]] size_t num_bytes() const { return bytes.size() - position; }
  [[nodiscard]] size_t num_words() const { return num_bytes() / kWordBytes; }
  [[nodiscard]] size_t num_words_to_stop() const { return stop > position ? (stop - position) / kWordBytes : 0; }
  [[nodiscard]] uint64_t byte(size_t offset) const { return first_byte + position + offset; }
};

/// Finds damage in RAW words, ahead of decoding. If a word is implausible, the following ones show whether it alone is
/// damaged, and is then dropped, or whether bytes are missing, in which case the stream resumes where words are valid
/// again.
template <typename WordCodec>
class WordDamage {
 public:
  using Input = WordInput<WordCodec::kWordBytes>;

  enum class Step { kGoOn, kNeedMore, kEnd, kRestart };

  explicit WordDamage(const SensorLimits& limits) : limits_(limits) {}

  /// Finds the first valid words, at the start and after damage, and drops what precedes them. Returns false if more
  /// bytes are needed. `state` is that of decoding.
  bool find_words(Input& input, typename WordCodec::State& state) {
    return (started_ || start(input)) && (!lost_ || find_alignment(input, state));
  }

  /// Checks the next words.
  void extend_check(const Input& input) {
    size_t words = input.num_words();
    if (input.stop != Input::kNoStop) words = std::min(words, input.num_words_to_stop() + kHoldWords);
    if (problem_ != Problem::kNone || checked_ >= words || checked_ > kHoldWords) return;
    const size_t count = std::min(words - checked_, kBlockWords);
    const size_t good = WordCodec::check(input.data() + checked_ * kWordBytes, count, check_, limits_);
    checked_ += good;
    if (good < count) problem_ = Problem::kUnresolved;
  }

  /// Returns the number of words that may be decoded now.
  [[nodiscard]] size_t num_ready(const Input& input) const {
    if (problem_ == Problem::kSkipWord) return checked_;
    if (has_jump()) return keep_;
    if (problem_ == Problem::kNone && input.ended && checked_ == input.num_words()) return checked_;
    return checked_ > kHoldWords ? checked_ - kHoldWords : 0;
  }

  /// Treats the next word, if none may be decoded.
  Step next_step(Input& input, typename WordCodec::State& state) {
    switch (problem_) {
      case Problem::kNone:
        if (checked_ < input.num_words()) return Step::kGoOn;
        return input.ended ? Step::kEnd : Step::kNeedMore;
      case Problem::kUnresolved:
        return resolve(input, WordCodec::time(state));
      case Problem::kSkipWord:
        WordCodec::drop_word(input.data(), state);
        input.position += kWordBytes;
        break;
      case Problem::kBreak:
        WordCodec::forget(state, check_);
        [[fallthrough]];
      case Problem::kPadding:
        input.position += jump_;
        checked_ = keep_ = jump_ = 0;
        break;
      case Problem::kRestart:
        if (jump_ > 0) input.summary->add(Violation::kTruncated, input.byte(0));
        input.position += jump_;
        return Step::kRestart;
    }
    problem_ = Problem::kNone;
    return Step::kGoOn;
  }

  /// Declares words as done.
  void advance(Input& input, size_t words) {
    input.position += words * kWordBytes;
    checked_ -= words;
    if (has_jump()) {
      keep_ -= words;
      jump_ -= words * kWordBytes;
    }
  }

  /// Continues after a place where bytes are missing.
  void pass_break(uint64_t byte, DecodeSummary& summary, typename WordCodec::State& state) {
    summary.add(Violation::kMisaligned, byte);
    open_gap(byte, WordCodec::time(state));
    checked_ = keep_ = jump_ = 0;
    problem_ = Problem::kNone;
    WordCodec::forget(state, check_);
  }

  /// Counts the gap that the last break has opened, if there is one: decoding continues at this time.
  void close_gap(int64_t time_us, DecodeSummary& summary) {
    if (gap_) summary.add_gap({gap_->begin_us, std::max(gap_->begin_us, time_us), gap_->byte});
    gap_.reset();
  }

  /// Returns the number of bytes from the position on that have been inspected.
  [[nodiscard]] size_t num_seen_bytes() const {
    return std::max((checked_ + (problem_ == Problem::kNone ? 0 : 1)) * kWordBytes, jump_);
  }

  /// Returns whether the stream continues here as within undamaged data.
  [[nodiscard]] bool is_steady() const { return started_ && !lost_ && !has_jump(); }

  /// Takes the heartbeat from an earlier state, because too few words were seen here to know it.
  void take_heartbeat(const WordDamage& before) {
    check_.heartbeat = before.check_.heartbeat;
    decisions_ = {};
  }

  /// Returns whether `end`, reached from the state `guess`, equals the result of starting from `truth`; corrects the
  /// heartbeat in `end`.
  [[nodiscard]] static bool is_confirmed(const WordDamage& guess, const WordDamage& truth, WordDamage& end) {
    const int64_t late = truth.check_.heartbeat - guess.check_.heartbeat;
    if (end.decisions_.lowest_yes + late < 0 || end.decisions_.highest_no + late >= 0) return false;
    if (!guess.is_same_but_heartbeat(truth)) return false;
    end.check_.heartbeat += late;
    return true;
  }

  static constexpr size_t kBlockWords = 2048;

 private:
  static constexpr size_t kWordBytes = WordCodec::kWordBytes;
  static constexpr size_t kNone = SIZE_MAX;

  /// The values of the heartbeat at which it decided something: the nearest to the opposite answer on both sides.
  struct Decisions {
    int64_t lowest_yes = INT64_MAX / 2;
    int64_t highest_no = INT64_MIN / 2;
  };

  enum class Problem { kNone, kUnresolved, kSkipWord, kBreak, kPadding, kRestart };

  /// A recording may begin anywhere: checks once whether the first bytes are aligned.
  bool start(Input& input) {
    if (input.num_words() < kWindowWords && !input.ended) return false;
    started_ = true;
    const size_t window = std::min(input.num_words(), kMinWindowWords);
    lost_ = window == kMinWindowWords && WordCodec::count_bad(input.data(), window, window) * 4 > window;
    if (lost_) input.summary->add(Violation::kMisaligned, input.byte(0));
    return true;
  }

  /// Decides how to treat the word at which the check stopped.
  Step resolve(Input& input, int64_t time_us) {
    const size_t behind = input.num_words() - checked_ - 1;
    if (behind < kWindowWords && !input.ended) return Step::kNeedMore;
    const size_t word = checked_ * kWordBytes;
    bool is_whole = false;
    const size_t header = find_header(input, word + kWindowWords * kWordBytes, is_whole);
    if (header == kNone) return resolve_word(input, time_us);
    if (!is_whole) return Step::kNeedMore;
    if (header <= word + kWordBytes - 1) return jump(Problem::kRestart, header);
    // The words before the header are judged without it.
    Input in_front = input;
    in_front.bytes = input.bytes.first(input.position + header);
    in_front.ended = true;
    return resolve_word(in_front, time_us);
  }

  Step resolve_word(Input& input, int64_t time_us) {
    const uint8_t* word = input.data() + checked_ * kWordBytes;
    const size_t behind = input.num_words() - checked_ - 1;
    if (const size_t padding = WordCodec::num_padding(word, behind + 1, check_); padding > 0) {
      return jump(Problem::kPadding, (checked_ + padding) * kWordBytes);
    }
    const size_t window = std::min(behind, kWindowWords);
    const size_t bad = WordCodec::count_bad(word + kWordBytes, window, kWindowBad + 1);
    const bool is_break = bad > std::max<size_t>(window * kWindowBad / kWindowWords, 1);
    if (is_break && !is_cut_by_zeros(input)) return begin_break(input, time_us);
    const Violation fault = WordCodec::classify(word, check_, limits_);
    if (fault == Violation::kTimeBackwards || fault == Violation::kTimeJump) {
      const Verdict verdict = WordCodec::judge_time(word, behind + 1, input.ended, check_);
      if (verdict == Verdict::kNeedMore) return Step::kNeedMore;
      if (verdict == Verdict::kRestart) return jump(Problem::kRestart, checked_ * kWordBytes);
      if (verdict == Verdict::kAccept) {
        // The events up to the last time are raised to it.
        if (fault == Violation::kTimeBackwards) input.summary->add(fault, input.byte(checked_ * kWordBytes));
        return accept_time(input, word, time_us);
      }
      if (WordCodec::coarse_time(word)) ++check_.num_rejected;
    }
    input.summary->add_dropped(fault, input.byte(checked_ * kWordBytes));
    problem_ = Problem::kSkipWord;
    return Step::kGoOn;
  }

  /// Decodes what was checked, then continues at this byte from the position on.
  Step jump(Problem problem, size_t byte) {
    keep_ = std::min(checked_, byte / kWordBytes);
    jump_ = byte;
    problem_ = problem;
    return Step::kGoOn;
  }

  /// Returns whether keep_ and jump_ state where to continue.
  [[nodiscard]] bool has_jump() const { return problem_ >= Problem::kBreak; }

  /// Returns the offset of the header of another file in the first `end` bytes from the position, or kNone. Since
  /// text is not a plausible sequence of words for long, no other place is inspected. `is_whole` is set if the header
  /// is complete.
  size_t find_header(const Input& input, size_t end, bool& is_whole) const {
    const std::string_view text = as_text(input.bytes.subspan(input.position)).substr(0, end);
    for (size_t at = text.find("% "); at != std::string_view::npos; at = text.find("% ", at + 1)) {
      const auto bytes = input.bytes.subspan(input.position + at);
      const auto header = parse_raw_header(bytes, input.ended, "");
      is_whole = header || header.error().code != ErrorCode::kTruncated;
      if (!is_whole || is_raw_header(bytes)) return at;
    }
    return kNone;
  }

  /// A jump in a stream with a heartbeat means that data are missing or that the clock starts again.
  Step accept_time(Input& input, const uint8_t* word, int64_t time_us) {
    constexpr CoarseClock kClock = WordCodec::kClock;
    const auto last = WordCodec::coarse_time(check_), next = WordCodec::coarse_time(word);
    const uint32_t steps = last && next ? (*next - *last) & kClock.mask : 0;
    if (steps > 1 && has_heartbeat()) {
      const int64_t step_us = int64_t{steps} << kClock.step_bits;
      if (step_us > kWrapRestartUs && *next < *last && *next < (kWrapRestartUs >> kClock.step_bits)) {
        return jump(Problem::kRestart, checked_ * kWordBytes);
      }
      const uint64_t byte = input.byte(checked_ * kWordBytes);
      input.summary->add(Violation::kTimeJump, byte);
      input.summary->add_gap({time_us, time_us + step_us, byte});
    }
    WordCodec::accept_time(word, check_);
    ++checked_;
    problem_ = Problem::kNone;
    return Step::kGoOn;
  }

  bool has_heartbeat() {
    const int64_t heartbeat = check_.heartbeat;
    if (heartbeat < 0) {
      decisions_.highest_no = std::max(decisions_.highest_no, heartbeat);
    } else {
      decisions_.lowest_yes = std::min(decisions_.lowest_yes, heartbeat);
    }
    return heartbeat >= 0;
  }

  [[nodiscard]] bool is_same_but_heartbeat(const WordDamage& other) const {
    auto check = check_;
    check.heartbeat = other.check_.heartbeat;
    return check == other.check_ && checked_ == other.checked_ && problem_ == other.problem_ && keep_ == other.keep_ &&
           jump_ == other.jump_ && started_ == other.started_ && lost_ == other.lost_ &&
           dropped_bytes_ == other.dropped_bytes_ && gap_ == other.gap_;
  }

  [[nodiscard]] bool is_aligned(const uint8_t* data, size_t words) const {
    constexpr size_t kFirst = 8;
    return WordCodec::count_bad(data, kFirst, 1) == 0 &&
           WordCodec::count_bad(data, words, kResumeBad + 1) <= kResumeBad;
  }

  /// Returns the next offset >= `offset` at which words are valid within the first `end` bytes, or the first offset
  /// that cannot be decided yet.
  size_t next_alignment(const Input& input, size_t offset, size_t end, bool& found) const {
    const size_t needed = input.ended ? kMinWindowWords : kWindowWords;
    for (found = false; offset + needed * kWordBytes <= end; ++offset) {
      const size_t words = std::min(kWindowWords, (end - offset) / kWordBytes);
      found = is_aligned(input.data() + offset, words);
      if (found) break;
    }
    return offset;
  }

  /// Handles missing or wrong bytes around the word at which the check stopped: finds where the stream continues, and
  /// how many of the held words certainly precede the damage.
  Step begin_break(Input& input, int64_t time_us) {
    if (check_.num_zeros > kMaxZeros) return begin_zeros(input, time_us);
    const size_t word = checked_ * kWordBytes;
    bool found = false;
    // Not further than the wait: the result must not depend on how many bytes happen to be available.
    const size_t seen = std::min(input.num_bytes(), word + kJudgeWords * kWordBytes);
    jump_ = next_alignment(input, word + 1, seen, found);
    if (!found && !input.ended && seen < word + kJudgeWords * kWordBytes) return Step::kNeedMore;
    lost_ = !found;
    keep_ = checked_ - std::min<size_t>(checked_, 8);
    if (found && (jump_ - word) % kWordBytes != 0) {
      size_t begin = jump_;
      while (begin >= kWordBytes && WordCodec::count_bad(input.data() + begin - kWordBytes, 1, 1) == 0)
        begin -= kWordBytes;
      keep_ = std::min(checked_, begin / kWordBytes);
    }
    input.summary->add(Violation::kMisaligned, input.byte(word));
    count_dropped(input, jump_ - keep_ * kWordBytes);
    open_gap(input.byte(word), time_us);
    problem_ = Problem::kBreak;
    return Step::kGoOn;
  }

  [[nodiscard]] static bool is_zero(const Input& input, size_t word) {
    const uint8_t* const bytes = input.data() + word * kWordBytes;
    return std::all_of(bytes, bytes + kWordBytes, [](uint8_t byte) { return byte == 0; });
  }

  /// Returns whether a run of zero bytes begins within the word at which the check stopped. This word is dropped alone,
  /// so that the zero words behind it are counted as such.
  [[nodiscard]] bool is_cut_by_zeros(const Input& input) const {
    const size_t end = checked_ + 1 + kMaxZeros + 1;
    if (is_zero(input, checked_) || end > input.num_words()) return false;
    for (size_t i = checked_ + 1; i < end; ++i) {
      if (!is_zero(input, i)) return false;
    }
    return true;
  }

  /// Drops a run of zero words, such as the unwritten rest of an interrupted copy. What stands before it is complete.
  Step begin_zeros(Input& input, int64_t time_us) {
    const size_t first = checked_ - std::min<size_t>(checked_, kMaxZeros);
    // As above, not further than the wait.
    const size_t most = std::min(input.num_words(), checked_ + kJudgeWords);
    size_t end = checked_;
    while (end < most && is_zero(input, end)) ++end;
    if (end == input.num_words() && !input.ended && end < checked_ + kJudgeWords) return Step::kNeedMore;
    input.summary->add_dropped(Violation::kZeros, input.byte(first * kWordBytes), end - first);
    open_gap(input.byte(first * kWordBytes), time_us);
    keep_ = first;
    jump_ = end * kWordBytes;
    problem_ = Problem::kBreak;
    return Step::kGoOn;
  }

  /// Counts dropped bytes in words; the remainder is carried over to the next call.
  void count_dropped(const Input& input, size_t bytes) {
    dropped_bytes_ += bytes;
    input.summary->dropped_words += dropped_bytes_ / kWordBytes;
    dropped_bytes_ %= kWordBytes;
  }

  void open_gap(uint64_t byte, int64_t time_us) {
    if (!gap_) gap_ = {time_us, time_us, byte};
  }

  /// Continues to search for valid words and drops everything before.
  bool find_alignment(Input& input, typename WordCodec::State& state) {
    if (problem_ == Problem::kBreak) return true;  // what was kept is decoded first
    bool found = false;
    size_t skipped = next_alignment(input, 0, input.num_bytes(), found);
    if (!found && input.ended) skipped = input.num_bytes();
    bool is_whole = false;
    if (const size_t header = find_header(input, skipped + 1, is_whole); header != kNone) {
      if (!is_whole) return false;
      lost_ = false;
      input.position += header;
      count_dropped(input, header);
      jump(Problem::kRestart, 0);
      return true;
    }
    input.position += skipped;
    count_dropped(input, skipped);
    lost_ = !found && !input.ended;
    if (found) WordCodec::forget(state, check_);
    return !lost_;
  }

  SensorLimits limits_;
  typename WordCodec::Check check_;
  size_t checked_ = 0;  ///< number of words from the position on that are valid
  Problem problem_ = Problem::kNone;
  size_t keep_ = 0;  ///< at a break: number of words to decode before it,
  size_t jump_ = 0;  ///< and where to continue, in bytes from the position
  bool started_ = false;
  bool lost_ = false;           ///< the alignment is unknown
  size_t dropped_bytes_ = 0;    ///< number of bytes that were not counted as a word yet
  std::optional<TimeGap> gap_;  ///< opened by the last break
  Decisions decisions_;
};

}  // namespace e2lf::recordings
