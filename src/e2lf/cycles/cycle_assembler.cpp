// SPDX-License-Identifier: MIT
#include "e2lf/cycles/cycle_assembler.h"

#include <algorithm>
#include <bit>
#include <functional>

#include "e2lf/base/result.h"

namespace e2lf::cycles {
void PixelFilter::apply(capture::EventImages& images) {
  constexpr size_t kMostCycles = 16;    // in the sums
  constexpr uint64_t kSearchEvery = 8;  // cycles, after the first ones
  sums_.add(images);
  ++added_;
  if (added_ % kSearchEvery == 0 || (added_ < kSearchEvery && std::has_single_bit(added_)))
    hot_ = capture::hot_pixels(sums_);
  if (sums_.cycles == kMostCycles) sums_.fade();
  capture::replace_by_neighbours(hot_, images);
}

namespace {

/// The share of the last pattern's time that the recording must cover for its last cycle to count as complete.
constexpr double kEnoughOfLastPattern = 0.5;
/// The number of cycles for which events are counted at most, in case a cycle does not end.
constexpr int64_t kMaxCyclesCounted = 4;
/// The number of cycles at the beginning that are always whole, so that confidence and polarity are known.
constexpr uint64_t kWholeAtBegin = 3;

/// Returns a quarter of the shortest pattern, which excludes the preceding and following bursts. The upper limit is
/// longer than the rise of a burst.
int64_t evidence_window_us(const Schedule& schedule) {
  int64_t shortest_us = INT64_MAX;
  for (const ScheduledPattern& pattern : schedule.patterns) {
    shortest_us = std::min(shortest_us, pattern.interval_us());
  }
  return std::clamp<int64_t>(shortest_us / 4, 2 * EventHistogram::kBinUs, 2500);
}

}  // namespace

CycleAssembler::CycleAssembler(const CycleOptions& options, size_t width, size_t height)
    : options_(options),
      width_(width),
      height_(height),
      first_pattern_(options.schedule.first_of_cycle()),
      window_us_(evidence_window_us(options.schedule)) {
  if (options.filters_pixels) filter_.emplace();
}

void CycleAssembler::add_start(const PatternStart& start) {
  const auto later = [](int64_t t_us, const PatternStart& s) { return t_us < s.t_us; };
  starts_.insert(std::upper_bound(starts_.begin(), starts_.end(), start.t_us, later), start);
}

void CycleAssembler::add_events(recordings::EventColumns& events) {
  if (next_ == events_.size()) {
    std::swap(events_, events);  // no events are waiting, so no copy is needed
    next_ = 0;
  } else {
    if (next_ > events_.size() / 2) {
      events_.erase(0, std::exchange(next_, 0));
    }
    events_.append(events);
  }
  give_up_waiting();
}

void CycleAssembler::give_up_waiting() {
  if (events_.size() - next_ <= options_.max_waiting_events) return;
  const size_t given_up = events_.size() - next_ - options_.max_waiting_events;
  report_.events_given_up += given_up;
  next_ += given_up;
  if (open_) set_fault(CycleFault::kLost);
}

void CycleAssembler::process(int64_t until_us, const PatternTracker* tracker) {
  while (!starts_.empty() && starts_.front().t_us < until_us) {
    const PatternStart start = starts_.front();
    starts_.pop_front();
    close_overdue(start.t_us);
    consume_events(start.t_us);
    apply(start, tracker);
  }
  close_overdue(until_us);
  // Until the next start is seen or overdue, the events after the expected end must wait.
  consume_events(pattern_ ? std::min(until_us, expected_end_us_) : until_us);
}

bool CycleAssembler::is_last_of_cycle(size_t pattern) const {
  return (pattern + 1) % options_.schedule.size() == first_pattern_;
}

/// Ends a pattern at its expected end if no start has occurred although it is overdue.
void CycleAssembler::close_overdue(int64_t until_us) {
  if (!pattern_ || until_us <= deadline_us_) return;
  const bool is_last = is_last_of_cycle(*pattern_);
  consume_events(expected_end_us_);
  close_pattern(expected_end_us_);
  if (is_last) end_cycle();
}

void CycleAssembler::finish(int64_t last_us) {
  if (!open_) return;
  const bool is_last = pattern_ && is_last_of_cycle(*pattern_);
  const auto enough_us = static_cast<int64_t>(
      is_last ? kEnoughOfLastPattern * static_cast<double>(options_.schedule.patterns[*pattern_].duration_us) : 0);
  if (!is_last || last_us < pattern_begin_us_ + enough_us) set_fault(CycleFault::kPartial);
  consume_events(expected_end_us_);
  close_pattern(expected_end_us_);
  end_cycle();
}

std::optional<Cycle> CycleAssembler::take() {
  if (complete_.empty()) return std::nullopt;
  Cycle cycle = std::move(complete_.front());
  complete_.pop_front();
  return cycle;
}

void CycleAssembler::begin_cycle(int64_t t_us) {
  open_ = Open{};
  open_->cycle.number = next_number_++;
  const uint64_t number = open_->cycle.number;
  open_->is_whole = report_.complete < kWholeAtBegin || number % whole_every_ == 0;
  open_->cycle.begin_us = t_us;
  open_->cycle.images = capture::EventImages(options_.schedule.num_images(), height_, width_);
  open_->cycle.pattern_events.resize(options_.schedule.size());
}

void CycleAssembler::set_fault(CycleFault fault) {
  if (!open_ || open_->fault) return;
  open_->fault = DroppedCycle{open_->cycle.number, open_->cycle.begin_us, fault};
}

void CycleAssembler::end_cycle() {
  if (!open_) return;
  if (open_->cycle.starts.size() < options_.schedule.size()) set_fault(CycleFault::kPartial);
  if (open_->fault) {
    ++report_.dropped[static_cast<size_t>(open_->fault->fault)];
    if (report_.drops.size() < CycleReport::kMaxDrops) report_.drops.push_back(*open_->fault);
  } else {
    ++report_.complete;
    set_confidence();
    if (filter_) {
      filter_->apply(open_->cycle.images);
      report_.hot_pixels = filter_->num_hot();
    }
    complete_.push_back(std::move(open_->cycle));
  }
  open_.reset();
}

/// Sets the confidence; that of a cycle that was not read as a whole is the last known one.
void CycleAssembler::set_confidence() {
  Cycle& cycle = open_->cycle;
  if (open_->is_whole) {
    whole_confidence_ = confidence_of(cycle.starts);
  } else {
    cycle.pattern_events.clear();
  }
  cycle.confidence = whole_confidence_;
}

std::optional<TimeSlice> CycleAssembler::unused_time(const PatternTracker& tracker) const {
  if (!pattern_ || !open_ || open_->is_whole || whole_every_ == 1) return std::nullopt;
  const auto& patterns = options_.schedule.patterns;
  TimeSlice unused{pattern_begin_us_ + window_us_, pattern_begin_us_ - window_us_};
  for (size_t i = *pattern_; !patterns[i].image; i = (i + 1) % patterns.size()) {
    unused.end_us += tracker.interval_us(i);
    // The next cycle may be whole.
    if (is_last_of_cycle(i)) break;
  }
  return unused.begin_us < unused.end_us ? std::optional(unused) : std::nullopt;
}

/// Returns the smallest confidence of the starts. Bursts consist of events, but a start that a trigger or the schedule
/// claims must be confirmed by events: by the two most certain of the changes whose sign is known. Slow pixels do not
/// allow a stricter test: they make few events between a pattern and its inverse, and change smoothly between two
/// patterns that transmit nearly the same light.
float CycleAssembler::confidence_of(const std::vector<PatternStart>& starts) const {
  float least = 1.0F;
  for (const PatternStart& start : starts) least = std::min(least, start.confidence);
  if (options_.source == CycleSource::kBursts) return least;
  std::vector<float> confirmed, confirmed_sign;
  for (const PatternStart& start : starts) {
    const ScheduledPattern& pattern = options_.schedule.patterns[start.pattern];
    if (!pattern.image && pattern.sign == BurstSign::kAny) continue;
    const float confidence = std::max(change_confidence(histogram_, start.t_us, window_us_, pattern.sign),
                                      abrupt_change_confidence(histogram_, start.t_us, window_us_, pattern.sign));
    confirmed.push_back(confidence);
    if (pattern.sign != BurstSign::kAny) confirmed_sign.push_back(confidence);
  }
  if (confirmed.empty()) return least;
  if (confirmed_sign.size() < 3) return least * *std::min_element(confirmed.begin(), confirmed.end());
  std::partial_sort(confirmed_sign.begin(), confirmed_sign.begin() + 2, confirmed_sign.end(), std::greater<>());
  return least * confirmed_sign[1];
}

void CycleAssembler::apply(const PatternStart& start, const PatternTracker* tracker) {
  if (start.kind == PatternStart::Kind::kDoubled) return set_fault(CycleFault::kDoubled);
  close_pattern(start.t_us);
  if (start.kind == PatternStart::Kind::kLost) {
    set_fault(CycleFault::kLost);
    end_cycle();
    return;
  }
  if (start.pattern == first_pattern_) end_cycle();
  // The first cycle of a recording may begin in its middle; it is then dropped as a partial one.
  if (!open_) begin_cycle(start.t_us);
  if (start.kind == PatternStart::Kind::kMissing) set_fault(CycleFault::kMissing);
  open_->cycle.starts.push_back(start);
  pattern_ = start.pattern;
  pattern_begin_us_ = start.t_us;
  const ScheduledPattern& pattern = options_.schedule.patterns[start.pattern];
  const int64_t expected_us = tracker != nullptr ? tracker->interval_us(start.pattern) : pattern.interval_us();
  expected_end_us_ = start.t_us + expected_us;
  deadline_us_ = expected_end_us_ + static_cast<int64_t>(options_.tracker.tolerance * static_cast<double>(expected_us));
}

void CycleAssembler::close_pattern(int64_t end_us) {
  if (!pattern_) return;
  if (open_) open_->cycle.end_us = end_us;
  if (open_ && options_.schedule.patterns[*pattern_].image) open_->cycle.slices.push_back({pattern_begin_us_, end_us});
  pattern_.reset();
}

void CycleAssembler::consume_events(int64_t until_us) {
  const auto begin = events_.t.begin() + static_cast<ptrdiff_t>(next_);
  const auto end = static_cast<size_t>(std::lower_bound(begin, events_.t.end(), until_us) - events_.t.begin());
  if (pattern_ && open_) {
    PatternEvents& events = open_->cycle.pattern_events[*pattern_];
    const uint64_t on = recordings::count_on(std::span(events_.p).subspan(next_, end - next_));
    events.on += on;
    events.off += end - next_ - on;
    if (options_.schedule.patterns[*pattern_].image) accumulate(next_, end);
  }
  if (options_.source != CycleSource::kBursts) {
    histogram_.add(events_, next_, end);
    const int64_t newest_us = next_ < end ? events_.t[end - 1] : INT64_MIN / 2;
    const int64_t oldest_us = open_ ? open_->cycle.begin_us : newest_us;
    histogram_.forget_before(
        std::max(oldest_us - 2 * window_us_, newest_us - kMaxCyclesCounted * options_.schedule.cycle_us()));
  }
  next_ = end;
}

void CycleAssembler::accumulate(size_t begin, size_t end) {
  Cycle& cycle = open_->cycle;
  const std::span<int16_t> image = cycle.images.image(*options_.schedule.patterns[*pattern_].image);
  const uint16_t* const x = events_.x.data();
  const uint16_t* const y = events_.y.data();
  // Images exceed the nearest caches: the pixels of later events are prefetched while the present ones are counted.
  constexpr size_t kAhead = 32;
  for (size_t i = begin; i < end; ++i) {
    const size_t later = std::min(i + kAhead, end - 1);
    __builtin_prefetch(image.data() + std::min(y[later] * width_ + x[later], image.size() - 1), 1);
    if (x[i] >= width_ || y[i] >= height_) continue;
    int16_t& count = image[y[i] * width_ + x[i]];
    // Counts saturate at the limits of int16; this branch is hardly ever taken.
    int16_t sum = 0;
    if (__builtin_add_overflow(count, events_.p[i] != 0 ? 1 : -1, &sum)) {
      ++cycle.saturated;
    } else {
      count = sum;
    }
  }
  cycle.events += end - begin;
}

}  // namespace e2lf::cycles
