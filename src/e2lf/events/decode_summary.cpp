// SPDX-License-Identifier: MIT
#include "e2lf/events/decode_summary.h"

#include "e2lf/base/text.h"

namespace e2lf::events {
namespace {

struct ViolationText {
  const char* name;
  const char* text;
};

constexpr std::array<ViolationText, kNumViolations> kTexts = {{
    {"unknown_word", "a word of unknown type"},
    {"out_of_range", "an event outside the sensor"},
    {"time_backwards", "time runs backwards"},
    {"time_jump", "time jumps ahead"},
    {"misaligned", "bytes are missing or inserted"},
    {"truncated", "the data ends inside a word, record or packet"},
    {"bad_record", "a record that cannot be read"},
}};

}  // namespace

const char* violation_name(Violation kind) {
  return kTexts[static_cast<size_t>(kind)].name;
}

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

void DecodeSummary::add_gap(const TimeGap& gap) {
  if (gaps.size() < kMaxGaps) gaps.push_back(gap);
  ++num_gaps;
}

void DecodeSummary::append(const DecodeSummary& later) {
  if (later.events() > 0) {
    if (events() == 0) first_t_us = later.first_t_us;
    last_t_us = later.last_t_us;
  }
  events_on += later.events_on;
  events_off += later.events_off;
  triggers += later.triggers;
  events_before_time += later.events_before_time;
  time_loops += later.time_loops;
  dropped_words += later.dropped_words;
  for (size_t kind = 0; kind < kNumViolations; ++kind) {
    add(static_cast<Violation>(kind), later.violations[kind].first_byte, later.violations[kind].count);
  }
  for (const TimeGap& gap : later.gaps) add_gap(gap);
  num_gaps += later.num_gaps - later.gaps.size();
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
  return {code, cat("the recording is damaged: ", violation_text(first), "; use another policy to read the rest"),
          cat(name, ": byte ", summary.of(first).first_byte)};
}

}  // namespace e2lf::events
