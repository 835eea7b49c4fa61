// SPDX-License-Identifier: MIT
#include "python/binding/recording.h"

#include <algorithm>
#include <limits>

#include "e2lf/info/recording_report.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::python {
namespace {

constexpr const char* kWhat = "recording";
/// For one thread, decoded events should still be in its cache when they are converted; several threads get larger
/// parts.
constexpr size_t kCachedBatch = size_t{1} << 16;
constexpr int64_t kEver = std::numeric_limits<int64_t>::max();

/// Returns the largest multiple of `step` at or before a time.
int64_t multiple_below(int64_t t_us, int64_t step) {
  const int64_t rest = t_us % step;
  return t_us - (rest < 0 ? rest + step : rest);
}

}  // namespace

recordings::OpenOptions open_options(const std::string& name, const OpenArguments& arguments) {
  if (arguments.threads < 0) throw py::value_error("the number of threads cannot be negative; 0 is all cores");
  recordings::OpenOptions options;
  options.format = arguments.format;
  options.width = arguments.width;
  options.height = arguments.height;
  options.stream = arguments.stream;
  options.columns = arguments.columns;
  options.polarities = arguments.polarities;
  options.time_unit = value_of(arguments.time_unit, recordings::kTimeUnits, "time_unit");
  options.restart = value_of(arguments.restart, recordings::kRestartPolicies, "restart");
  options.from_us = arguments.from_us.value_or(INT64_MIN);
  options.to_us = arguments.to_us.value_or(INT64_MAX);
  if (options.from_us >= options.to_us) {
    throw ResultError({ErrorCode::kInvalidValue, "the range of time is empty; give a later to_us", "from_us"});
  }
  options.range = arguments.relative ? recordings::TimeOrigin::kZero : recordings::TimeOrigin::kAbsolute;
  options.time = arguments.shift_time ? recordings::TimeOrigin::kZero : recordings::TimeOrigin::kAbsolute;
  options.threads = arguments.threads;
  options.camera = arguments.camera_setup.value_or(recordings::CameraSetup());
  // With a camera, damage is reported at once; for a file, the summary at the end is sufficient.
  options.policy = arguments.strict                      ? recordings::DecodePolicy::kStrict
                   : recordings::is_live_recording(name) ? recordings::DecodePolicy::kReport
                                                         : recordings::DecodePolicy::kSkip;
  return options;
}

std::unique_ptr<recordings::RecordingReader> open_reader(const std::string& name, const OpenArguments& arguments,
                                                         bool reads_parts) {
  const recordings::OpenOptions options = open_options(name, arguments);
  if (options.restart == recordings::RestartPolicy::kSplit && !reads_parts) {
    throw ResultError({ErrorCode::kInvalidValue,
                       "\"split\" is only for open_recording(), whose next_part() continues; use \"continue\"",
                       "restart"});
  }
  const StopOnInterrupt interrupt(recordings::is_live_recording(name));
  return without_gil([&]() -> Result<std::unique_ptr<recordings::RecordingReader>> {
    E2LF_ASSIGN_OR_RETURN(auto reader, recordings::open_named_recording(name, options));
    info::log_assumptions(*reader);
    return reader;
  });
}

void check_live(const recordings::DecodeSummary& summary) {
  if (!summary.live.failure.empty()) throw ResultError({ErrorCode::kIo, summary.live.failure, ""});
}

Recording::Recording(std::string name, std::unique_ptr<recordings::RecordingReader> reader,
                     std::optional<int64_t> from_us)
    : name_(std::move(name)),
      is_live_(recordings::is_live_recording(name_)),
      reader_(std::move(reader)),
      most_events_(reader_->options().threads == 1 ? kCachedBatch : recordings::RecordingReader::kDefaultBatch),
      slice_begin_us_(from_us) {
  count_readers(+1);
}

Recording::~Recording() {
  count_readers(-1);
}

recordings::RecordingReader& Recording::reader() const {
  if (!reader_) throw py::value_error("the recording is closed");
  return *reader_;
}

void Recording::discard_batch() {
  batch_.clear();
  event_ = trigger_ = 0;
  has_ended_ = false;
}

std::optional<Slice> Recording::next(const SliceSize& size) {
  const OneAtATime::Use use(use_, kWhat);
  static_cast<void>(reader());
  std::optional<Slice> slice;
  {
    const StopOnInterrupt interrupt(is_live_);
    slice = without_gil([&] { return read_slice(size); });
  }
  check_signals();
  if (!slice && !std::exchange(has_failed_, true)) check_live(reader_->summary());
  return slice;
}

Slice Recording::between(int64_t begin_us, int64_t end_us) {
  const OneAtATime::Use use(use_, kWhat);
  Slice slice;
  slice.begin_us = begin_us;
  slice.end_us = end_us;
  without_gil([&]() -> Result<void> {
    E2LF_RETURN_IF_ERROR(reader().seek(begin_us));
    discard_batch();
    return fill(slice, std::nullopt, end_us);
  });
  slice_begin_us_ = end_us;
  check_signals();
  return slice;
}

bool Recording::next_part() {
  const OneAtATime::Use use(use_, kWhat);
  const bool more = without_gil([&] { return reader().next_part(); });
  if (!more) return false;
  discard_batch();
  slice_begin_us_.reset();
  return true;
}

void Recording::seek(int64_t t_us) {
  const OneAtATime::Use use(use_, kWhat);
  without_gil([&] { return reader().seek(t_us); });
  discard_batch();
  slice_begin_us_ = t_us;
}

recordings::DecodeSummary Recording::summary() {
  const OneAtATime::Use use(use_, kWhat);
  return reader().summary();
}

void Recording::close() {
  const OneAtATime::Use use(use_, kWhat);
  discard_batch();
  batch_ = {};
  reader_.reset();
}

/// Reads the next batch if the last one was returned completely. Returns false at the end of the recording.
Result<bool> Recording::refill() {
  if (event_ < batch_.events.size() || trigger_ < batch_.triggers.size()) return true;
  if (has_ended_) return false;
  event_ = trigger_ = 0;
  E2LF_ASSIGN_OR_RETURN(const bool more, reader_->read(batch_, most_events_));
  has_ended_ = !more;
  if (has_ended_) info::warn_of_losses(name_, reader_->summary());
  return more;
}

/// Returns the time of the first event or trigger that was not returned yet.
int64_t Recording::next_us() const {
  const int64_t event_us = event_ < batch_.events.size() ? batch_.events.t[event_] : kEver;
  const int64_t trigger_us = trigger_ < batch_.triggers.size() ? batch_.triggers[trigger_].t : kEver;
  return std::min(event_us, trigger_us);
}

Result<std::optional<Slice>> Recording::read_slice(const SliceSize& size) {
  E2LF_ASSIGN_OR_RETURN(const bool more, refill());
  if (!more) return std::optional<Slice>();
  Slice slice;
  slice.begin_us = next_us();
  if (size.delta_us) {
    // Events after a full slice may belong to its last microsecond.
    slice.begin_us =
        slice_begin_us_ ? std::min(*slice_begin_us_, slice.begin_us) : multiple_below(slice.begin_us, *size.delta_us);
  }
  if (!size.delta_us && !size.events) {
    take_events(slice, batch_.events.size());
    take_triggers(slice, kEver);
  } else {
    E2LF_RETURN_IF_ERROR(fill(slice, size.events, size.delta_us ? slice.begin_us + *size.delta_us : kEver));
  }
  const bool is_full = size.events && slice.events.size() == *size.events;
  if (size.delta_us && !is_full) {
    slice.end_us = slice.begin_us + *size.delta_us;
  } else {
    const int64_t last_event_us = slice.events.empty() ? slice.begin_us : slice.events.back().t;
    const int64_t last_trigger_us = slice.triggers.empty() ? slice.begin_us : slice.triggers.back().t;
    slice.end_us = std::max(last_event_us, last_trigger_us) + 1;
  }
  if (size.delta_us) slice_begin_us_ = slice.end_us;
  return std::optional<Slice>(std::move(slice));
}

/// Takes the data before end_us, limited to a number of events. Triggers are returned with the events before them.
Result<void> Recording::fill(Slice& slice, std::optional<size_t> most_events, int64_t end_us) {
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, refill());
    if (!more) return {};
    const auto& t = batch_.events.t;
    const auto first = t.begin() + static_cast<ptrdiff_t>(event_);
    size_t end = static_cast<size_t>(std::lower_bound(first, t.end(), end_us) - t.begin());
    if (most_events) end = std::min(end, event_ + *most_events - slice.events.size());
    take_events(slice, end);
    const bool is_full = most_events && slice.events.size() == *most_events;
    take_triggers(slice, is_full ? std::min(end_us, slice.events.back().t + 1) : end_us);
    if (is_full || event_ < t.size() || trigger_ < batch_.triggers.size()) return {};
  }
}

void Recording::take_events(Slice& slice, size_t end) {
  if (end == event_) return;
  if (slice.events.capacity() == 0) slice.events = take_records();
  append_records(batch_.events, event_, end, slice.events);
  event_ = end;
}

void Recording::take_triggers(Slice& slice, int64_t end_us) {
  while (trigger_ < batch_.triggers.size() && batch_.triggers[trigger_].t < end_us) {
    slice.triggers.push_back(batch_.triggers[trigger_++]);
  }
}

}  // namespace e2lf::python
