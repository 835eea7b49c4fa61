// SPDX-License-Identifier: MIT
#include "e2lf/recordings/recording.h"

#include <algorithm>
#include <sstream>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"

namespace e2lf::recordings {

bool has_settings(CameraSetup setup) {
  setup.running = nullptr;
  return setup != CameraSetup();
}

Result<std::vector<SensorRegion>> parse_regions(const std::string& text) {
  std::vector<SensorRegion> regions;
  std::istringstream words(text == "all" ? "" : text);
  for (std::string word; words >> word;) {
    SensorRegion region;
    int length = 0;
    const int found =
        std::sscanf(word.c_str(), "%5d,%5d,%5d,%5d%n", &region.x, &region.y, &region.width, &region.height, &length);
    if (found != 4 || static_cast<size_t>(length) != word.size()) {
      return fail(ErrorCode::kInvalidValue, "", "\"", word, "\" is not a region; give X,Y,WIDTH,HEIGHT");
    }
    regions.push_back(region);
  }
  return regions;
}

std::optional<std::string> RecordingInfo::find(const std::string& key) const {
  for (const auto& [name, value] : header) {
    if (name == key) return value;
  }
  return std::nullopt;
}

RecordingReader::RecordingReader(BlocksPtr blocks, RecordingInfo info, const std::string& name,
                                 const OpenOptions& options, BlocksPtr triggers)
    : options_(options),
      info_(std::move(info)),
      name_(name),
      timeline_(std::move(blocks), std::move(triggers), info_.width, info_.height, name) {}

std::optional<std::chrono::steady_clock::time_point> RecordingReader::arrival() const {
  return timeline_.blocks() == nullptr ? std::nullopt : timeline_.blocks()->arrival();
}

/// Reads a section of the timeline and shifts the times of later parts behind those of earlier ones. Stops before a
/// later part that is to be kept separate; the batch then begins with that part.
Result<bool> RecordingReader::read_one_clock(EventBatch& batch, size_t max_events) {
  const size_t gaps = summary_.gaps.size();
  if (timeline_.blocks() != nullptr) timeline_.blocks()->limit_block(max_events);
  E2LF_ASSIGN_OR_RETURN(const bool more, timeline_.next(batch, summary_));
  if (const auto restart = timeline_.take_restart()) joint_ = restart;
  if (joint_ && !batch.empty()) E2LF_RETURN_IF_ERROR(join_part(batch.first_us()));
  if (part_shift_us_ != 0) {
    batch.shift(part_shift_us_);
    for (size_t i = gaps; i < summary_.gaps.size(); ++i) {
      summary_.gaps[i].begin_us += part_shift_us_;
      summary_.gaps[i].end_us += part_shift_us_;
    }
  }
  return more;
}

/// Decides how to treat a part whose first time is known.
Result<void> RecordingReader::join_part(int64_t first_us) {
  Restart restart = *std::exchange(joint_, std::nullopt);
  if (first_us >= restart.before_us) return {};  // consecutive recordings with the same clock
  restart.after_us = first_us;
  has_restarted_ = true;
  switch (options_.restart) {
    case RestartPolicy::kContinue:
      part_shift_us_ += restart.before_us + 1 - first_us;
      restart.shift_us = part_shift_us_;
      break;
    case RestartPolicy::kSplit:
      is_between_parts_ = true;
      break;
    case RestartPolicy::kRefuse:
      return fail(ErrorCode::kFormat, restart.byte == 0 ? name_ : cat(name_, ": byte ", restart.byte),
                  "the clock starts again here, from ", restart.before_us, " back to ", first_us,
                  " us: the camera was restarted, or files were joined; shift the later part behind the "
                  "earlier one (continue), or keep them separate (split)")
          .about("restart");
  }
  summary_.add_restart(restart);
  if (options_.policy == DecodePolicy::kReport) {
    DecodeSummary reported;
    reported.add_restart(restart);
    log_warning(cat(name_, ": ", restart_text(reported)));
  }
  return {};
}

Result<bool> RecordingReader::next_part() {
  // Data at or after options_.to_us were not read.
  for (bool more = has_ended_; more && !is_between_parts_;) {
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kDefaultBatch));
  }
  if (!std::exchange(is_between_parts_, false)) return false;
  summary_ = {};
  known_violations_ = {};
  shift_us_.reset();
  range_origin_us_ = 0;
  has_begun_ = has_ended_ = false;
  is_first_part_ = false;
  return true;
}

Result<bool> RecordingReader::refill_pending(size_t max_events) {
  if (is_between_parts_) return false;
  E2LF_ASSIGN_OR_RETURN(const bool more, read_one_clock(pending_.refill(), max_events));
  E2LF_RETURN_IF_ERROR(apply_policy());
  return !is_between_parts_ && (more || !pending_.empty());
}

Result<void> RecordingReader::find_shift() {
  if (shift_us_) return {};
  if (options_.time == TimeOrigin::kAbsolute && options_.range == TimeOrigin::kAbsolute) {
    shift_us_ = 0;
    return {};
  }
  bool more = true;
  while (more && pending_.empty()) {
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kMinBatch));
  }
  if (pending_.empty()) return {};
  const int64_t first_us = pending_.batch().first_us();
  shift_us_ = options_.time == TimeOrigin::kZero ? first_us : 0;
  if (options_.range == TimeOrigin::kZero) range_origin_us_ = first_us;
  return {};
}

/// Returns what was left out before the bytes reached this reader; see Camera::left_out().
DecodeSummary RecordingReader::left_out_before() const {
  DecodeSummary before;
  for (const auto& losses : losses_before_) before.append(losses());
  return before;
}

/// A stop request or the failure of a camera can come between any two reads, so an incomplete word at this point is not
/// damage.
void RecordingReader::pass_over_cut(const DecodeSummary& before) {
  ViolationCount& cut = summary_.of(Violation::kTruncated);
  const uint64_t known = known_violations_[static_cast<size_t>(Violation::kTruncated)];
  if (stop_requested() || !before.live.failure.empty()) cut = {known, known == 0 ? 0 : cut.first_byte};
}

Result<void> RecordingReader::apply_policy() {
  const DecodeSummary before = left_out_before();
  pass_over_cut(before);
  if (options_.policy == DecodePolicy::kStrict && before.num_violations() > 0) return violation_error(before, name_);
  if (options_.policy == DecodePolicy::kStrict && summary_.events_before_time + before.events_before_time > 0) {
    return fail(ErrorCode::kFormat, name_,
                "there are events before the first time, which strict reading refuses; otherwise they are left out and "
                "counted");
  }
  if (options_.policy == DecodePolicy::kStrict && summary_.other_streams + before.other_streams > 0) {
    return Error{ErrorCode::kInvalidValue,
                 cat("there are several streams of events, ", join(info_.streams),
                     ", and strict reading does not leave any out; select one"),
                 name_, "stream"};
  }
  for (size_t i = 0; i < kNumViolations; ++i) {
    const ViolationCount& violation = summary_.violations[i];
    const bool first = violation.count > 0 && known_violations_[i] == 0;
    known_violations_[i] = violation.count;
    if (!first) continue;
    if (options_.policy == DecodePolicy::kStrict) return violation_error(summary_, name_);
    if (options_.policy == DecodePolicy::kReport) {
      log_warning(cat(name_, ": byte ", violation.first_byte, ": ", violation_text(static_cast<Violation>(i)),
                      "; the damaged part is dropped"));
    }
  }
  return {};
}

void RecordingReader::count(const EventColumns& events) {
  if (events.empty()) return;
  if (summary_.events() == 0) summary_.first_t_us = events.t.front();
  summary_.last_t_us = events.t.back();
  const uint64_t on = count_on(events.p);
  summary_.events_on += on;
  summary_.events_off += events.size() - on;
}

DecodeSummary RecordingReader::summary() const {
  DecodeSummary shifted = summary_;
  shifted.add_losses(left_out_before());
  const int64_t shift_us = shift_us_.value_or(0);
  if (shifted.events() > 0) {
    shifted.first_t_us -= shift_us;
    shifted.last_t_us -= shift_us;
  }
  for (TimeGap& gap : shifted.gaps) {
    gap.begin_us -= shift_us;
    gap.end_us -= shift_us;
  }
  return shifted;
}

/// Converts a time of the options to the sensor's clock.
int64_t RecordingReader::in_range(int64_t t_us) const {
  return std::clamp(t_us, -kTimeLimitUs, kTimeLimitUs) + range_origin_us_;
}

/// Seeks to a time if the source is seekable; otherwise skips everything before it.
Result<void> RecordingReader::begin_at(int64_t absolute_us) {
  const auto sought = timeline_.seek_before(absolute_us);
  if (!sought && sought.error().code != ErrorCode::kUnsupported) return sought;
  if (sought) pending_.refill();
  return skip_to(absolute_us);
}

Result<void> RecordingReader::skip_to(int64_t absolute_us) {
  for (bool more = true;;) {
    pending_.skip_to(pending_.first_event(absolute_us), pending_.first_trigger(absolute_us));
    if (!pending_.empty() || !more) return {};
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kDefaultBatch));
    if (is_between_parts_) return {};
  }
}

/// Removes everything at or after a time from a batch, which is then the last one.
void RecordingReader::end_at(int64_t absolute_us, EventBatch& batch) {
  const auto is_late = [absolute_us](const auto& t_us) { return t_us >= absolute_us; };
  const auto event = std::find_if(batch.events.t.begin(), batch.events.t.end(), is_late);
  const auto trigger = std::find_if(batch.triggers.begin(), batch.triggers.end(),
                                    [&](const Trigger& candidate) { return is_late(candidate.t); });
  has_ended_ = event != batch.events.t.end() || trigger != batch.triggers.end();
  batch.events.resize(static_cast<size_t>(event - batch.events.t.begin()));
  batch.triggers.erase(trigger, batch.triggers.end());
}

Result<bool> RecordingReader::read(EventBatch& batch, size_t max_events) {
  E2LF_REQUIRE(max_events >= kMinBatch, "a batch holds at least kMinBatch events");
  batch.clear();
  // A live source ends by itself, after what has arrived.
  if (stop_requested() && !arrival()) return false;
  if (is_between_parts_) return false;
  E2LF_RETURN_IF_ERROR(find_shift());
  if (has_ended_) return false;
  if (!std::exchange(has_begun_, true) && options_.from_us != INT64_MIN) {
    const int64_t from_us = in_range(options_.from_us);
    E2LF_RETURN_IF_ERROR(is_first_part_ ? begin_at(from_us) : skip_to(from_us));
  }
  if (is_between_parts_) return false;
  for (bool more = true; more && pending_.empty() && batch.empty();) {
    E2LF_ASSIGN_OR_RETURN(more, read_one_clock(batch, max_events));
    E2LF_RETURN_IF_ERROR(apply_policy());
  }
  const bool is_too_large = std::max(batch.events.size(), batch.triggers.size()) > max_events;
  if (is_between_parts_ || is_too_large) std::swap(pending_.refill(), batch);
  if (is_between_parts_) return false;
  if (batch.empty()) pending_.take(batch, max_events);
  if (options_.to_us != INT64_MAX) end_at(in_range(options_.to_us), batch);
  count(batch.events);
  summary_.triggers += batch.triggers.size();
  if (const int64_t shift_us = shift_us_.value_or(0); shift_us != 0) batch.shift(-shift_us);
  return !batch.empty();
}

void RecordingReader::skip_events(int64_t begin_us, int64_t end_us) {
  const int64_t shift_us = shift_us_.value_or(0) - part_shift_us_;
  if (timeline_.blocks() != nullptr) timeline_.blocks()->skip_events(begin_us + shift_us, end_us + shift_us);
}

Result<void> RecordingReader::seek(int64_t t_us) {
  E2LF_RETURN_IF_ERROR(find_shift());
  int64_t absolute_us = t_us + shift_us_.value_or(0);
  if (options_.from_us != INT64_MIN) absolute_us = std::max(absolute_us, in_range(options_.from_us));
  summary_ = {};
  known_violations_ = {};
  pending_.refill();
  has_begun_ = is_first_part_ = true;
  has_ended_ = is_between_parts_ = false;
  joint_.reset();
  part_shift_us_ = 0;
  E2LF_RETURN_IF_ERROR(timeline_.seek_before(has_restarted_ ? -kTimeLimitUs : absolute_us));
  return skip_to(absolute_us);
}

Result<EventBatch> read_all(RecordingReader& reader) {
  EventBatch all;
  EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader.read(batch));
    if (!more) return all;
    all.append(batch);
  }
}

}  // namespace e2lf::recordings
