// SPDX-License-Identifier: MIT
#include "e2lf/cycles/cycle_reader.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/cycles/cycle_assembler.h"

namespace e2lf::cycles {
namespace {

constexpr size_t kBatchEvents = size_t{1} << 16;
/// How far kAuto searches for triggers.
constexpr int64_t kCyclesAhead = 2;
constexpr size_t kEventsAhead = 1'000'000, kMaxEventsAhead = 16'000'000;

/// Returns a time after a delay, limited to the times that exist: before the first event, it is INT64_MIN.
int64_t delayed(int64_t t_us, int64_t delay_us) {
  int64_t sum_us = 0;
  if (!__builtin_add_overflow(t_us, delay_us, &sum_us)) return sum_us;
  return delay_us < 0 ? INT64_MIN : INT64_MAX;
}

/// Returns the schedule for the tracker: with one trigger per cycle, it is one pattern as long as the cycle.
Schedule tracked_schedule(const CycleOptions& options) {
  if (options.source != CycleSource::kTriggers || !options.one_trigger_per_cycle) return options.schedule;
  ScheduledPattern cycle;
  cycle.duration_us = options.schedule.cycle_us();
  return {.patterns = {cycle}};
}

TrackerOptions tracker_options(const CycleOptions& options) {
  TrackerOptions tracker = options.tracker;
  if (options.source == CycleSource::kBursts) tracker.likely_first_pattern.reset();
  if (options.source == CycleSource::kTriggers && options.one_trigger_per_cycle) tracker.first_pattern = 0;
  return tracker;
}

/// The first batches of a recording, which are read to search for triggers.
struct Beginning {
  std::deque<recordings::EventBatch> batches;
  bool has_triggers = false;
};

/// Reads until a trigger is found, or until one should have occurred: after two cycles in a live recording, where
/// cycles wait for it; in other recordings only after a million events as well, since they may begin before the
/// aperture moves.
Result<Beginning> read_beginning(recordings::RecordingReader& reader, const CycleOptions& options) {
  Beginning beginning;
  std::optional<int64_t> first_us;
  size_t events = 0;
  for (recordings::EventBatch batch; !beginning.has_triggers;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader.read(batch, kBatchEvents));
    if (!more) break;
    // Triggers of another channel or edge are a mistake that can be stated; bursts would hide it.
    beginning.has_triggers = !batch.triggers.empty();
    events += batch.events.size();
    bool is_long = false;
    if (!batch.events.empty()) {
      if (!first_us) first_us = batch.events.t.front();
      is_long = batch.events.t.back() - *first_us >= kCyclesAhead * options.schedule.cycle_us();
    }
    beginning.batches.push_back(std::move(batch));
    if (is_long && (events >= kEventsAhead || reader.arrival())) break;
    if (events >= kMaxEventsAhead) break;
  }
  return beginning;
}

}  // namespace

class CycleReader::Impl {
 public:
  Impl(std::unique_ptr<recordings::RecordingReader> reader, const CycleOptions& options, Beginning beginning)
      : reader_(std::move(reader)),
        beginning_(std::move(beginning.batches)),
        options_(options),
        tracker_(tracked_schedule(options), tracker_options(options)),
        assembler_(options, reader_->info().width, reader_->info().height) {}

 private:
  friend class CycleReader;

  [[nodiscard]] Result<void> check_filter() const {
    const uint64_t hot = assembler_.report().hot_pixels;
    const uint64_t all = uint64_t{reader_->info().width} * reader_->info().height;
    const double share = static_cast<double>(hot) / static_cast<double>(all);
    if (share <= kMostHotShare) return {};
    return fail(ErrorCode::kInvalidValue, reader_->name(), hot, " of ", all, " pixels (", std::round(1000 * share) / 10,
                " %) have far more events than their neighbours, which are too many for defects of a sensor; do not ",
                "replace hot pixels")
        .about("filter_pixels");
  }

  /// Returns the next batch, first those that were read in advance and then from the recording.
  Result<bool> read_batch() {
    if (beginning_.empty()) return reader_->read(batch_, kBatchEvents);
    batch_ = std::move(beginning_.front());
    beginning_.pop_front();
    return true;
  }

  /// Reads one batch and processes what has become known.
  Result<void> advance() {
    E2LF_ASSIGN_OR_RETURN(const bool more, read_batch());
    has_ended_ = !more;
    if (options_.invert_polarity) {
      for (uint8_t& p : batch_.events.p) p = p != 0 ? 0 : 1;
    }
    if (options_.on_batch) options_.on_batch(batch_);
    last_us_ = std::max(last_us_, batch_.last_us());
    found_.clear();
    int64_t known_us = last_us_;
    switch (options_.source) {
      case CycleSource::kSchedule:
        add_scheduled_starts();
        break;
      case CycleSource::kTriggers:
        add_starts_of_triggers();
        // Triggers that are yet to come may begin patterns at earlier times.
        known_us = delayed(known_us, std::min<int64_t>(options_.trigger_delay_us, 0));
        known_us = tracker_.known_until(has_ended_ ? INT64_MAX : signer_.known_until(known_us));
        break;
      case CycleSource::kBursts:
        bursts_.add(batch_.events, found_);
        if (has_ended_) bursts_.finish(found_);
        starts_.clear();
        for (const Mark& mark : found_) add_mark(mark);
        add_starts();
        known_us = tracker_.known_until(has_ended_ ? INT64_MAX : bursts_.known_until_us());
        break;
      case CycleSource::kAuto:
        E2LF_REQUIRE(false, "the source was decided on when the recording was opened");
    }
    assembler_.add_events(batch_.events);
    assembler_.process(has_ended_ ? INT64_MAX : known_us, tracker_by_pattern());
    if (has_ended_) assembler_.finish(last_us_);
    skip_unused_events();
    return {};
  }

  /// Lets the recording leave out the events up to the next image, in cycles that are not read as a whole.
  void skip_unused_events() {
    if (has_ended_ || !tracker_.is_locked()) return;
    const auto unused = assembler_.unused_time(tracker_);
    if (!unused) return;
    has_skipped_ = true;
    reader_->skip_events(unused->begin_us, unused->end_us);
  }

  void add_starts() {
    if (has_ended_) tracker_.finish(starts_);
    for (const PatternStart& start : starts_) add_start(start);
  }

  void add_mark(const Mark& mark) {
    ++marks_;
    if (options_.on_mark && options_.source == CycleSource::kBursts) options_.on_mark(mark);
    tracker_.add(mark, starts_);
  }

  /// Adds the starts of triggers. They are used at once while the pattern is known; otherwise, each waits for the sign
  /// of its events.
  void add_starts_of_triggers() {
    starts_.clear();
    for (const recordings::Trigger& trigger : batch_.triggers) {
      if (!is_of(trigger, options_.channel, options_.edge)) continue;
      found_.push_back({delayed(trigger.t, options_.trigger_delay_us), {}, 1.0F});
    }
    if (options_.on_mark) show_triggers();
    signer_.add(batch_.events, found_);
    while (const auto mark = signer_.take(/*needs_sign=*/!tracker_.is_locked(), has_ended_)) add_mark(*mark);
    add_starts();
  }

  /// Reports each trigger with its sign to the observer, even while the tracker does not need the sign.
  void show_triggers() {
    shown_signer_.add(batch_.events, found_);
    while (const auto mark = shown_signer_.take(/*needs_sign=*/true, has_ended_)) options_.on_mark(*mark);
  }

  /// Adds the starts up to the last time that was read. The first cycle whose event images lie in the recording is
  /// number 0.
  void add_scheduled_starts() {
    if (batch_.empty()) return;
    if (!next_start_us_) {
      const int64_t first_us = std::min(batch_.events.empty() ? INT64_MAX : batch_.events.t.front(),
                                        batch_.triggers.empty() ? INT64_MAX : batch_.triggers.front().t);
      next_pattern_ = options_.schedule.first_of_cycle();
      int64_t begin_us = options_.origin_us;  // the beginning of a cycle
      for (size_t i = 0; i < next_pattern_; ++i) begin_us += options_.schedule.patterns[i].interval_us();
      int64_t images_us = begin_us;
      for (size_t i = next_pattern_; i < options_.schedule.first_image_pattern(); ++i) {
        images_us += options_.schedule.patterns[i].interval_us();
      }
      const int64_t period_us = options_.schedule.cycle_us(), since_us = first_us - images_us;
      const int64_t cycles = since_us / period_us + (since_us % period_us > 0);
      next_start_us_ = begin_us + cycles * period_us;
    }
    while (*next_start_us_ <= last_us_) {
      assembler_.add_start({*next_start_us_, next_pattern_, PatternStart::Kind::kSeen, 1.0F});
      *next_start_us_ += options_.schedule.patterns[next_pattern_].interval_us();
      next_pattern_ = (next_pattern_ + 1) % options_.schedule.size();
    }
  }

  /// Returns the tracker if its patterns are those of the schedule, otherwise null.
  const PatternTracker* tracker_by_pattern() const {
    const bool has_all_patterns = options_.source == CycleSource::kBursts ||
                                  (options_.source == CycleSource::kTriggers && !options_.one_trigger_per_cycle);
    return has_all_patterns ? &tracker_ : nullptr;
  }

  /// Adds a start. With one trigger per cycle, it determines the starts of all patterns of the cycle, in proportion to
  /// the schedule.
  void add_start(const PatternStart& start) {
    const bool is_fault = start.kind == PatternStart::Kind::kDoubled || start.kind == PatternStart::Kind::kLost;
    if (options_.source != CycleSource::kTriggers || !options_.one_trigger_per_cycle || is_fault)
      return assembler_.add_start(start);
    const double scale =
        static_cast<double>(tracker_.interval_us(0)) / static_cast<double>(options_.schedule.cycle_us());
    double offset_us = 0;
    for (size_t i = 0; i < options_.schedule.size(); ++i) {
      PatternStart of_pattern = start;
      of_pattern.pattern = i;
      of_pattern.t_us += static_cast<int64_t>(offset_us * scale);
      assembler_.add_start(of_pattern);
      offset_us += static_cast<double>(options_.schedule.patterns[i].interval_us());
    }
  }

  std::unique_ptr<recordings::RecordingReader> reader_;
  std::deque<recordings::EventBatch> beginning_;  ///< read in advance to search for triggers
  CycleOptions options_;
  PatternTracker tracker_;
  BurstDetector bursts_;
  TriggerSigns signer_, shown_signer_;
  CycleAssembler assembler_;
  recordings::EventBatch batch_;
  std::vector<Mark> found_;
  std::vector<PatternStart> starts_;
  int64_t last_us_ = INT64_MIN;
  bool has_ended_ = false;
  bool has_skipped_ = false;  ///< events of some patterns
  uint64_t marks_ = 0, saturated_ = 0;
  std::optional<int64_t> next_start_us_;  ///< kSchedule
  size_t next_pattern_ = 0;
};

const char* option_of_first_pattern(const CycleOptions& options) {
  if (options.source == CycleSource::kSchedule) return "origin_us";
  const bool may_have_triggers = options.source != CycleSource::kBursts;
  return may_have_triggers && options.one_trigger_per_cycle ? "trigger_delay_us" : "first_pattern";
}

Result<CycleReader> CycleReader::open(std::unique_ptr<recordings::RecordingReader> reader,
                                      const CycleOptions& options) {
  E2LF_RETURN_IF_ERROR(validate(options.schedule, "schedule"));
  const auto invalid = [&](const std::string& message) {
    return fail(ErrorCode::kInvalidValue, reader->name(), message);
  };
  if (options.tracker.first_pattern && *options.tracker.first_pattern >= options.schedule.size()) {
    return invalid(cat("the first pattern is ", *options.tracker.first_pattern, " of a schedule of ",
                       options.schedule.size(), "; count from 0"))
        .about("first_pattern");
  }
  if (const char* option = option_of_first_pattern(options);
      options.tracker.first_pattern && option != std::string("first_pattern")) {
    return invalid(
               "a cycle begins at the origin of the schedule, or at its only trigger; shift it, and omit the first "
               "pattern")
        .about(option);
  }
  if (!(options.tracker.tolerance > 0 && options.tracker.tolerance < 0.5)) {
    return invalid("the tolerance of intervals must be between 0 and 0.5");
  }
  if (reader->info().width == 0 || reader->info().height == 0) {
    return invalid("the recording does not state the size of the sensor; give its width and height")
        .about("sensor_width");
  }
  if (options.source != CycleSource::kAuto) {
    return CycleReader(std::make_unique<Impl>(std::move(reader), options, Beginning()));
  }
  E2LF_ASSIGN_OR_RETURN(Beginning beginning, read_beginning(*reader, options));
  CycleOptions decided = options;
  decided.source = beginning.has_triggers ? CycleSource::kTriggers : CycleSource::kBursts;
  return CycleReader(std::make_unique<Impl>(std::move(reader), decided, std::move(beginning)));
}

CycleReader::CycleReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CycleReader::CycleReader(CycleReader&&) noexcept = default;
CycleReader& CycleReader::operator=(CycleReader&&) noexcept = default;
CycleReader::~CycleReader() = default;

void CycleReader::read_whole_every(uint64_t cycles) {
  E2LF_REQUIRE(cycles > 0, "cycles are read as a whole now and then");
  const bool can_skip = source() == CycleSource::kTriggers && !options().one_trigger_per_cycle;
  impl_->assembler_.make_whole_every(can_skip ? cycles : 1);
  if (cycles == 1 && impl_->has_skipped_) impl_->reader_->skip_events(0, 0);
}

Result<std::optional<Cycle>> CycleReader::next() {
  for (;;) {
    if (auto cycle = impl_->assembler_.take()) {
      cycle->known_us = impl_->last_us_;
      cycle->arrival = recording().arrival();
      impl_->saturated_ += cycle->saturated;
      E2LF_RETURN_IF_ERROR(impl_->check_filter());
      if (cycle->saturated > 0 && recording().options().policy == recordings::DecodePolicy::kStrict) {
        return recordings::saturation_error(cycle->saturated, cat(recording().name(), ": cycle ", cycle->number));
      }
      return cycle;
    }
    if (impl_->has_ended_) return std::optional<Cycle>();
    E2LF_RETURN_IF_ERROR(impl_->advance());
  }
}

CycleReport CycleReader::report() const {
  CycleReport report = impl_->assembler_.report();
  report.marks = impl_->marks_;
  report.unassigned_marks = impl_->tracker_.unassigned_marks();
  report.has_assumed_first = impl_->tracker_.has_assumed_first();
  return report;
}

recordings::DecodeSummary CycleReader::summary() const {
  recordings::DecodeSummary summary = recording().summary();
  summary.saturated += impl_->saturated_;
  return summary;
}

const CycleOptions& CycleReader::options() const {
  return impl_->options_;
}
const recordings::RecordingReader& CycleReader::recording() const {
  return *impl_->reader_;
}

}  // namespace e2lf::cycles
