// SPDX-License-Identifier: MIT
#include "e2lf/live/live_reader.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/progress.h"

namespace e2lf::live {

Result<std::unique_ptr<LiveReader>> LiveReader::open(const OpenCycles& open, const ReadingOptions& options) {
  auto reader = std::make_unique<LiveReader>();
  reader->options_ = options;
  E2LF_ASSIGN_OR_RETURN(reader->cycles_,
                        open([self = reader.get()](const recordings::EventBatch& batch) { self->see(batch); }));
  const recordings::RecordingInfo& info = reader->cycles_->recording().info();
  reader->preview_.emplace(info.width, info.height);
  reader->recorder_.emplace(options.recordings, info);
  reader->report();
  return reader;
}

void LiveReader::see(const recordings::EventBatch& batch) {
  constexpr std::chrono::milliseconds kReportPeriod{500};
  const Clock::time_point now = Clock::now();
  statistics_.add_batch(batch, now);
  rig_.add(batch);
  if (!has_all_events_) {
    // Recordings start at the beginning of a cycle.
  } else if (options_.is_inverted && recorder_->is_recording()) {
    sent_ = batch;
    for (uint8_t& p : sent_.events.p) p = p != 0 ? 0 : 1;
    recorder_->write(sent_);
  } else {
    recorder_->write(batch);
  }
  preview_->add(batch);
  // The events of a file have no arrival time; they count as arrived when they are read.
  if (!batch.events.empty()) {
    arrivals_.add(cycles_->recording().arrival().value_or(now), batch.events.t.back());
  }
  if (now - reported_ < kReportPeriod) return;
  reported_ = now;
  report();
}

void LiveReader::report() {
  constexpr int64_t kCyclesBefore = 3;  // what is found earlier may be due to a few triggers
  Json rig = rig_.json(*cycles_);
  diagnose::Findings findings;
  if (rig_.seen_us() > kCyclesBefore * cycles_->schedule().cycle_us()) findings = rig_.findings(*cycles_);
  const std::lock_guard lock(findings_mutex_);
  findings.insert(findings.end(), other_findings_.begin(), other_findings_.end());
  rig["findings"] = diagnose::to_json(findings);
  announce(findings);
  statistics_.set_report(cycles_->report(), cycles_->summary(), std::move(rig));
}

void LiveReader::add_findings(const diagnose::Findings& findings) {
  const std::lock_guard lock(findings_mutex_);
  other_findings_.insert(other_findings_.end(), findings.begin(), findings.end());
  statistics_.add_findings(diagnose::to_json(findings));  // after the end, there is no further report
  announce(findings);
}

/// Passes findings on whose code is new. findings_mutex_ must be locked.
void LiveReader::announce(const diagnose::Findings& findings) {
  for (const diagnose::Finding& finding : findings) {
    if (announced_.insert(finding.code).second && options_.on_finding) options_.on_finding(finding);
  }
}

/// Requests all events while a recording or the picture for focusing needs them.
void LiveReader::choose_events() {
  constexpr uint64_t kWholeEvery = 20;
  has_all_events_ = recorder_->is_recording() || preview_->is_asked();
  cycles_->read_whole_every(has_all_events_ ? 1 : kWholeEvery);
}

Result<bool> LiveReader::next(LiveCycle& cycle) {
  if (stop_requested() || (options_.max_cycles != 0 && taken_ == options_.max_cycles)) return false;
  choose_events();
  E2LF_ASSIGN_OR_RETURN(std::optional<cycles::Cycle> next, cycles_->next());
  report();
  if (!next) return false;
  ++taken_;
  next->confidence = rig_.add(*next, cycles_->options());
  statistics_.add_cycle(next->confidence);
  cycle.number = next->number;
  cycle.begin_us = next->begin_us;
  cycle.end_us = next->slices.back().end_us;
  cycle.events = next->events;
  cycle.confidence = next->confidence;
  // Until bytes have arrived without delay, the clock estimates arrivals too late; events that were read have arrived.
  cycle.last_event = std::min(arrivals_.arrival_of(cycle.end_us), Clock::now());
  cycle.cycle_s = 0;
  if (previous_ && previous_->first < next->number) {
    cycle.cycle_s = 1e-6 * static_cast<double>(next->begin_us - previous_->second) /
                    static_cast<double>(next->number - previous_->first);
  }
  previous_ = {next->number, next->begin_us};
  preview_->add_cycle(next->number, next->images);
  cycle.counts = std::move(next->images);
  cycle.cycles = sum_.add(cycle.counts.events, average_);
  return true;
}

}  // namespace e2lf::live
