// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// How to treat data that violate their format. The damaged part is dropped in any case and never guessed.
enum class DecodePolicy {
  kStrict,  ///< the first violation is an error
  kSkip,    ///< violations are counted
  kReport,  ///< violations are counted, and the first of each kind is logged as a warning
};

/// The treatment of a clock that starts again within a recording, because a camera was restarted or recordings were
/// concatenated.
enum class RestartPolicy {
  kContinue,  ///< shift the later part so that its times follow those of the earlier part
  kSplit,     ///< read the parts separately; see RecordingReader::next_part()
  kRefuse,    ///< fail with an Error that states the position
};

/// Events that are earlier than their predecessors by at most this are sorted; see Timeline.
inline constexpr int64_t kDisorderUs = 10'000;

/// Number of times around a decrease by more than that which show whether the clock starts again there.
inline constexpr size_t kRestartWitnesses = 64;

enum class Violation {
  kUnknownWord,    ///< a word of a type that the format does not have; ignored
  kOutOfRange,     ///< an event outside the sensor; dropped
  kTimeBackwards,  ///< an event or time more than kDisorderUs (in RAW words, more than jitter) before an earlier one;
                   ///< dropped
  kTimeJump,       ///< time jumped ahead implausibly; the words up to the next plausible time are dropped
  kMisaligned,     ///< bytes were lost or inserted; words are dropped until the stream is valid again
  kTruncated,      ///< the data ends inside a word, record or packet
  kBadRecord,      ///< a record, row or packet that cannot be read; dropped
  kZeros,          ///< a zero word or record of a long run of them, which is not data; dropped
};
inline constexpr size_t kNumViolations = 8;

/// Returns a description of a violation for messages, e.g. "a word of unknown type".
[[nodiscard]] const char* violation_text(Violation kind);

/// The number of violations of one kind, and the byte of the file where the first occurred.
struct ViolationCount {
  uint64_t count = 0;
  uint64_t first_byte = 0;
  bool operator==(const ViolationCount&) const = default;
};

/// A time interval that was affected by damage: the events in (begin_us, end_us) may be incomplete.
struct TimeGap {
  int64_t begin_us = 0;
  int64_t end_us = 0;
  uint64_t byte = 0;  ///< position in the file
  bool operator==(const TimeGap&) const = default;
};

/// A position at which the clock of a recording starts again because the camera was restarted or files were joined.
struct Restart {
  uint64_t byte = 0;      ///< position in the file where the later part begins; 0 = unknown
  int64_t before_us = 0;  ///< last time before it, and
  int64_t after_us = 0;   ///< first time after it, each on the clock of its part
  int64_t shift_us = 0;   ///< added to the times of the later part
  bool operator==(const Restart&) const = default;
};

/// A position in live input at which bytes are missing.
struct LiveGap {
  uint64_t byte = 0;           ///< position in the bytes that were read
  uint64_t dropped_bytes = 0;  ///< number of bytes that arrived faster than they were read
  uint64_t lost_buffers = 0;   ///< number of buffers of unknown size that the camera or its driver lost
  bool operator==(const LiveGap&) const = default;
};

/// The delay between the arrival and the processing of live input, and what ended the input.
struct LiveBacklog {
  int64_t most_behind_us = 0;  ///< longest time that bytes waited to be read; 0 if the input is not live
  uint64_t pauses = 0;         ///< number of times that too many bytes were waiting
  bool loses_events = false;   ///< whether bytes were dropped in these pauses, since a camera does not wait
  uint64_t dropped_bytes = 0;  ///< number of bytes dropped in these pauses
  uint64_t lost_buffers = 0;   ///< number of buffers that the camera or its driver lost
  uint64_t num_gaps = 0;       ///< number of places where bytes are missing for either reason
  std::vector<LiveGap> gaps;   ///< the first DecodeSummary::kMaxGaps of them
  std::string failure = {};    ///< why the input ended early, e.g. an unplugged camera; empty if it did not
  void add_gap(const LiveGap& gap);
  bool operator==(const LiveBacklog&) const = default;
};

/// Statistics and losses of a reader since it was opened or last repositioned. Times are shifted like those of the
/// returned events.
struct DecodeSummary {
  uint64_t events_on = 0;
  uint64_t events_off = 0;
  uint64_t triggers = 0;
  int64_t first_t_us = 0;  ///< time of the first event; 0 if there was none
  int64_t last_t_us = 0;   ///< time of the last event

  uint64_t events_before_time =
      0;                       ///< dropped because no time was known yet, which is normal at the start of a RAW file
  uint64_t time_loops = 0;     ///< number of times that the sensor's clock wrapped around
  uint64_t out_of_order = 0;   ///< events that were sorted to their place
  uint64_t dropped_words = 0;  ///< words or records that were dropped because of a violation
  uint64_t other_streams = 0;  ///< packets or messages of event streams that were neither selected nor excluded by name
  uint64_t events_unplaced = 0;   ///< dropped because the word with their time or row was damaged
  uint64_t saturated = 0;         ///< events that exceeded the 16-bit counts of an event image
  uint64_t left_over_cycles = 0;  ///< complete cycles at the end, too few for another sum
  std::array<ViolationCount, kNumViolations> violations{};
  std::vector<TimeGap> gaps;  ///< the first kMaxGaps of num_gaps
  uint64_t num_gaps = 0;
  std::vector<Restart> restarts;  ///< the first kMaxGaps of num_restarts
  uint64_t num_restarts = 0;

  LiveBacklog live;

  /// The sensor's own counts, if the encoding reports them: events that it generated, and those that it sent.
  uint64_t sensor_events_in = 0;
  uint64_t sensor_events_sent = 0;

  static constexpr size_t kMaxGaps = 1000;

  [[nodiscard]] uint64_t events() const { return events_on + events_off; }
  [[nodiscard]] ViolationCount& of(Violation kind) { return violations[static_cast<size_t>(kind)]; }
  [[nodiscard]] const ViolationCount& of(Violation kind) const { return violations[static_cast<size_t>(kind)]; }
  [[nodiscard]] uint64_t num_violations() const;

  /// Adds `count` violations of one kind, the first of them at a byte.
  void add(Violation kind, uint64_t byte, uint64_t count = 1);

  /// Does the same for words or records, which were dropped because of it.
  void add_dropped(Violation kind, uint64_t byte, uint64_t count = 1);
  void add_gap(const TimeGap& gap);
  void add_restart(const Restart& restart);

  /// Adds the losses that occurred before this recording, e.g. in the file that is replayed.
  void add_losses(const DecodeSummary& before);

  /// Adds the summary of a later part of the same recording (times, counts, violations, gaps).
  void append(const DecodeSummary& later);

  bool operator==(const DecodeSummary&) const = default;
};

/// One reason why data of a recording were left out.
struct Loss {
  std::string reason;       ///< name in JSON output: that of a violation, or "before_first_time"
  std::string text;         ///< description that follows a count: "events outside the sensor"
  uint64_t count = 0;       ///< number of occurrences, at least 1
  uint64_t first_byte = 0;  ///< position of the first in the file; 0 = unknown
};

/// Returns all losses by reason; empty if everything was read.
[[nodiscard]] std::vector<Loss> losses(const DecodeSummary& summary);

/// Returns the losses in one line, "318265 events outside the sensor, 2 records that cannot be read (the first at byte
/// 12)".
[[nodiscard]] std::string loss_text(const std::vector<Loss>& losses);

/// Returns a message about the restarts of the clock; empty if there were none.
[[nodiscard]] std::string restart_text(const DecodeSummary& summary);

/// Live input that is read later than this is considered delayed.
inline constexpr int64_t kBehindUs = 1'000'000;

/// Returns a message about the delay of live input; empty if it was less than kBehindUs and nothing was lost.
[[nodiscard]] std::string live_text(const DecodeSummary& summary);

/// Returns a message about the events that the sensor itself dropped; empty if it did not count them.
[[nodiscard]] std::string sensor_text(const DecodeSummary& summary);

/// Returns the error of the strict policy for an event image whose counts are saturated.
[[nodiscard]] Error saturation_error(uint64_t events, const std::string& name);

/// Returns the error of the strict policy for the first violation in a summary (location "name: byte N").
[[nodiscard]] Error violation_error(const DecodeSummary& summary, const std::string& name);

}  // namespace e2lf::recordings
