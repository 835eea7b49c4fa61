// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/decode_summary.h"

#include <algorithm>

#include "e2lf/base/text.h"

namespace e2lf::recordings {
namespace {

struct ViolationText {
  const char* name;
  const char* text;
  const char* plural;
};

constexpr std::array<ViolationText, kNumViolations> kTexts = {{
    {"unknown_word", "a word of unknown type", "words of unknown type"},
    {"out_of_range", "an event outside the sensor", "events outside the sensor"},
    {"time_backwards", "time runs backwards", "events or times earlier than their predecessors"},
    {"time_jump", "time jumps ahead", "events or times far later than their successors"},
    {"misaligned", "bytes are missing or inserted", "places with missing or inserted bytes"},
    {"truncated", "the data ends inside a word, record or packet", "unfinished words, records or packets at the end"},
    {"bad_record", "a record that cannot be read", "records that cannot be read"},
    {"zero_words", "zeros in place of data",
     "zero words or records in place of data, as an interrupted copy leaves them"},
}};

/// The numbers that add up over the parts of a recording.
constexpr uint64_t DecodeSummary::*kCounts[] = {
    &DecodeSummary::events_on,          &DecodeSummary::events_off,       &DecodeSummary::triggers,
    &DecodeSummary::events_before_time, &DecodeSummary::time_loops,       &DecodeSummary::out_of_order,
    &DecodeSummary::dropped_words,      &DecodeSummary::other_streams,    &DecodeSummary::events_unplaced,
    &DecodeSummary::saturated,          &DecodeSummary::left_over_cycles, &DecodeSummary::sensor_events_in,
    &DecodeSummary::sensor_events_sent};

/// The losses that are not violations.
struct OtherLoss {
  uint64_t DecodeSummary::*count;
  const char* reason;
  const char* text;
};
constexpr OtherLoss kOtherLosses[] = {
    {&DecodeSummary::events_before_time, "before_first_time", "events before the first time"},
    {&DecodeSummary::other_streams, "other_stream", "packets of other event streams"},
    {&DecodeSummary::events_unplaced, "unplaced", "events whose time or row was lost with a damaged word"},
    {&DecodeSummary::saturated, "saturated", "events of pixels with more than 32,767 in an event image"},
    {&DecodeSummary::left_over_cycles, "left_over_cycles", "of the complete cycles, too few for another sum"},
};

}  // namespace

const char* violation_text(Violation kind) {
  return kTexts[static_cast<size_t>(kind)].text;
}

uint64_t DecodeSummary::num_violations() const {
  uint64_t sum = 0;
  for (const ViolationCount& violation : violations) sum += violation.count;
  return sum;
}

void DecodeSummary::add(Violation kind, uint64_t byte, uint64_t count) {
  if (count == 0) return;
  if (of(kind).count == 0) of(kind).first_byte = byte;
  of(kind).count += count;
}

void DecodeSummary::add_dropped(Violation kind, uint64_t byte, uint64_t count) {
  add(kind, byte, count);
  dropped_words += count;
}

void LiveBacklog::add_gap(const LiveGap& gap) {
  if (gaps.size() < DecodeSummary::kMaxGaps) gaps.push_back(gap);
  ++num_gaps;
}

void DecodeSummary::add_gap(const TimeGap& gap) {
  if (gaps.size() < kMaxGaps) gaps.push_back(gap);
  ++num_gaps;
}

void DecodeSummary::add_restart(const Restart& restart) {
  if (restarts.size() < kMaxGaps) restarts.push_back(restart);
  ++num_restarts;
}

void DecodeSummary::append(const DecodeSummary& later) {
  if (later.events() > 0) {
    if (events() == 0) first_t_us = later.first_t_us;
    last_t_us = later.last_t_us;
  }
  for (const auto count : kCounts) this->*count += later.*count;
  live.most_behind_us = std::max(live.most_behind_us, later.live.most_behind_us);
  live.pauses += later.live.pauses;
  live.loses_events = live.loses_events || later.live.loses_events;
  live.dropped_bytes += later.live.dropped_bytes;
  live.lost_buffers += later.live.lost_buffers;
  for (const LiveGap& gap : later.live.gaps) live.add_gap(gap);
  live.num_gaps += later.live.num_gaps - later.live.gaps.size();
  if (live.failure.empty()) live.failure = later.live.failure;
  for (size_t kind = 0; kind < kNumViolations; ++kind) {
    add(static_cast<Violation>(kind), later.violations[kind].first_byte, later.violations[kind].count);
  }
  for (const TimeGap& gap : later.gaps) add_gap(gap);
  num_gaps += later.num_gaps - later.gaps.size();
  for (const Restart& restart : later.restarts) add_restart(restart);
  num_restarts += later.num_restarts - later.restarts.size();
}

void DecodeSummary::add_losses(const DecodeSummary& before) {
  DecodeSummary left_out = before;
  left_out.events_on = left_out.events_off = left_out.triggers = left_out.time_loops = 0;
  append(left_out);
}

std::vector<Loss> losses(const DecodeSummary& summary) {
  std::vector<Loss> found;
  for (size_t kind = 0; kind < kNumViolations; ++kind) {
    const ViolationCount& violation = summary.violations[kind];
    if (violation.count == 0) continue;
    found.push_back({kTexts[kind].name, kTexts[kind].plural, violation.count, violation.first_byte});
  }
  for (const OtherLoss& loss : kOtherLosses) {
    if (const uint64_t count = summary.*loss.count; count > 0) found.push_back({loss.reason, loss.text, count, 0});
  }
  return found;
}

std::string loss_text(const std::vector<Loss>& losses) {
  std::vector<std::string> parts;
  for (const Loss& loss : losses) {
    const std::string place = loss.first_byte == 0 ? "" : cat(" (the first at byte ", loss.first_byte, ")");
    parts.push_back(cat(loss.count, " ", loss.text, place));
  }
  return join(parts);
}

std::string restart_text(const DecodeSummary& summary) {
  if (summary.num_restarts == 0) return "";
  std::vector<std::string> places;
  constexpr size_t kMost = 3;
  for (const Restart& restart : summary.restarts) {
    if (places.size() == kMost) break;
    const std::string place = restart.byte == 0 ? "" : cat("at byte ", restart.byte, " ");
    const std::string moved =
        restart.shift_us == 0 ? "" : cat("; the times of the later part were shifted by ", restart.shift_us, " us");
    places.push_back(cat(place, "from ", restart.before_us, " back to ", restart.after_us, " us", moved));
  }
  const uint64_t left = summary.num_restarts - places.size();
  return cat("the clock starts again ", summary.num_restarts == 1 ? "once" : cat(summary.num_restarts, " times"), ": ",
             join(places), left > 0 ? cat(", and ", left, " more") : "");
}

std::string live_text(const DecodeSummary& summary) {
  const LiveBacklog& live = summary.live;
  const std::string lost = live.lost_buffers == 0 ? ""
                                                  : cat("the camera or its driver lost ", live.lost_buffers,
                                                        live.lost_buffers == 1 ? " buffer" : " buffers");
  if (live.most_behind_us < kBehindUs && !live.loses_events) return lost;
  std::string behind =
      cat("processing fell up to ", static_cast<double>(live.most_behind_us / 100'000) * 0.1, " s behind the input");
  if (live.pauses > 0) behind += cat(", and the input paused ", live.pauses == 1 ? "once" : cat(live.pauses, " times"));
  behind += live.loses_events ? cat("; ", live.dropped_bytes, " bytes of the camera were dropped in these pauses")
            : lost.empty()    ? "; nothing is lost"
                              : "";
  return lost.empty() ? behind : cat(behind, "; ", lost);
}

std::string sensor_text(const DecodeSummary& summary) {
  if (summary.sensor_events_in == 0 && summary.sensor_events_sent == 0) return "";
  const uint64_t dropped = summary.sensor_events_in - std::min(summary.sensor_events_in, summary.sensor_events_sent);
  return cat("counted ", summary.sensor_events_in, " events and sent ", summary.sensor_events_sent, "; it dropped ",
             dropped, " itself");
}

Error saturation_error(uint64_t events, const std::string& name) {
  return {ErrorCode::kInvalidValue,
          cat("an event image cannot count ", events, " events of pixels with more than 32,767, which strict ",
              "reading refuses; filter hot pixels or show patterns for a shorter time"),
          name, "filter_pixels"};
}

Error violation_error(const DecodeSummary& summary, const std::string& name) {
  Violation first = Violation::kUnknownWord;
  for (size_t kind = 0; kind < kNumViolations; ++kind) {
    const ViolationCount& violation = summary.violations[kind];
    const ViolationCount& best = summary.of(first);
    if (violation.count > 0 && (best.count == 0 || violation.first_byte < best.first_byte)) {
      first = static_cast<Violation>(kind);
    }
  }
  const ErrorCode code = first == Violation::kTruncated ? ErrorCode::kTruncated : ErrorCode::kFormat;
  return {code,
          cat(violation_text(first), ", which strict reading refuses; otherwise such data are left out and counted"),
          cat(name, ": byte ", summary.of(first).first_byte)};
}

}  // namespace e2lf::recordings
