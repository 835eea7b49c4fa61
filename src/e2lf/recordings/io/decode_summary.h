// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// What to do with data that breaks its format. The damaged part is dropped in any case, never guessed.
enum class DecodePolicy {
  kStrict,  ///< the first violation is an Error
  kSkip,    ///< count it and go on
  kReport,  ///< count it, go on, and log the first of each kind as a warning
};

enum class Violation {
  kUnknownWord,    ///< a word of a type that the format does not have; ignored
  kOutOfRange,     ///< an event outside the sensor; dropped
  kTimeBackwards,  ///< time stepped back by more than jitter; the step is refused
  kTimeJump,       ///< time jumped ahead implausibly; the words up to the next believable time are dropped
  kMisaligned,     ///< bytes were lost or inserted; words dropped until the stream made sense again
  kTruncated,      ///< the data ends inside a word, record or packet
  kBadRecord,      ///< a record, row or packet that cannot be read; dropped
};
inline constexpr size_t kNumViolations = 7;

/// The name of a violation as used in JSON output, e.g. "unknown_word".
[[nodiscard]] const char* violation_name(Violation kind);

/// The same for people, e.g. "a word of unknown type".
[[nodiscard]] const char* violation_text(Violation kind);

/// How often one kind of violation was met, and the byte of the file where it was met first.
struct ViolationCount {
  uint64_t count = 0;
  uint64_t first_byte = 0;
  bool operator==(const ViolationCount&) const = default;
};

/// A stretch of time that damage took away: no event of (begin_us, end_us) is to be trusted as complete.
struct TimeGap {
  int64_t begin_us = 0;
  int64_t end_us = 0;
  uint64_t byte = 0;  ///< where in the file
  bool operator==(const TimeGap&) const = default;
};

/// A place where the clock of a recording starts again: the camera was restarted, or files were joined.
struct Restart {
  uint64_t byte = 0;      ///< of the file, where the later part begins; 0 = not known
  int64_t before_us = 0;  ///< the last time in front of it, and
  int64_t after_us = 0;   ///< the first one behind it, each as its part says
  int64_t shift_us = 0;   ///< what was added to the times of the later part
  bool operator==(const Restart&) const = default;
};

/// How far the processing of live input fell behind what arrived, and what ended it.
struct LiveBacklog {
  int64_t most_behind_us = 0;  ///< the longest time that bytes waited to be read; 0 for what is not live
  uint64_t pauses = 0;         ///< how often more bytes waited than may
  bool loses_events = false;   ///< bytes were dropped in these pauses: a camera does not wait
  uint64_t dropped_bytes = 0;  ///< in these pauses
  std::string failure = {};    ///< what ended the input before its end, e.g. an unplugged camera; empty = nothing
  bool operator==(const LiveBacklog&) const = default;
};

/// What a reader met since it was opened or last sought. Times are as handed out (shifted when asked to).
struct DecodeSummary {
  uint64_t events_on = 0;
  uint64_t events_off = 0;
  uint64_t triggers = 0;
  int64_t first_t_us = 0;  ///< of the first event; 0 when there was none
  int64_t last_t_us = 0;   ///< of the last event

  uint64_t events_before_time = 0;  ///< dropped because no time word had come yet: normal at the start of a RAW file
  uint64_t time_loops = 0;          ///< how often the sensor's clock wrapped
  uint64_t out_of_order = 0;        ///< events of a text, npy or npz file that were sorted to their place
  uint64_t dropped_words = 0;       ///< words or records dropped because of a violation
  uint64_t other_streams = 0;       ///< packets or messages of streams of events that nobody chose or left out by name
  uint64_t events_unplaced = 0;     ///< dropped because damage took the word that gives their time or row
  uint64_t saturated = 0;           ///< events for which an event image had no room: its counts are of 16 bits
  std::array<ViolationCount, kNumViolations> violations{};
  std::vector<TimeGap> gaps;  ///< the first kMaxGaps of num_gaps
  uint64_t num_gaps = 0;
  std::vector<Restart> restarts;  ///< the first kMaxGaps of num_restarts
  uint64_t num_restarts = 0;

  LiveBacklog live;

  /// What the sensor itself counted, where the encoding reports it: events that came in, and those it sent.
  uint64_t sensor_events_in = 0;
  uint64_t sensor_events_sent = 0;

  static constexpr size_t kMaxGaps = 1000;

  [[nodiscard]] uint64_t events() const { return events_on + events_off; }
  [[nodiscard]] ViolationCount& of(Violation kind) { return violations[static_cast<size_t>(kind)]; }
  [[nodiscard]] const ViolationCount& of(Violation kind) const { return violations[static_cast<size_t>(kind)]; }
  [[nodiscard]] uint64_t num_violations() const;

  /// Counts `count` violations of one kind, the first of them at a byte.
  void add(Violation kind, uint64_t byte, uint64_t count = 1);
  void add_gap(const TimeGap& gap);
  void add_restart(const Restart& restart);

  /// Adds what was left out on the way to this recording, e.g. of the file that is replayed.
  void add_losses(const DecodeSummary& before);

  /// Adds what a later part of the same recording met (times, counts, violations, gaps).
  void append(const DecodeSummary& later);

  bool operator==(const DecodeSummary&) const = default;
};

/// One reason for which something of a recording was left out.
struct Loss {
  std::string reason;       ///< as in JSON output: a violation's name, or "before_first_time"
  std::string text;         ///< for people, behind a count: "events outside the sensor"
  uint64_t count = 0;       ///< at least 1
  uint64_t first_byte = 0;  ///< of the file; 0 = not known
};

/// The account of all that was left out, by reason; empty when everything was read.
[[nodiscard]] std::vector<Loss> losses(const DecodeSummary& summary);

/// The same in one line, "318265 events outside the sensor, 2 records that cannot be read (the first at byte 12)".
[[nodiscard]] std::string loss_text(const std::vector<Loss>& losses);

/// The account of restarts, for people, in one line; empty when there were none.
[[nodiscard]] std::string restart_text(const DecodeSummary& summary);

/// Live input that is read later than that has fallen behind.
inline constexpr int64_t kBehindUs = 1'000'000;

/// The account of how far the processing of live input fell behind, for people; empty where it kept pace to
/// kBehindUs and nothing was lost.
[[nodiscard]] std::string live_text(const DecodeSummary& summary);

/// The account of what the sensor itself left out, for people; empty where it did not count.
[[nodiscard]] std::string sensor_text(const DecodeSummary& summary);

/// The Error that the strict policy returns for an event image whose counts do not suffice.
[[nodiscard]] Error saturation_error(uint64_t events, const std::string& name);

/// The Error that the strict policy returns for the first violation in a summary (location "name: byte N").
[[nodiscard]] Error violation_error(const DecodeSummary& summary, const std::string& name);

}  // namespace e2lf::recordings
