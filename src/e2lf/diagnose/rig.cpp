// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/rig.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "e2lf/base/text.h"
#include "e2lf/diagnose/hot_events.h"

namespace e2lf::diagnose {
namespace {

using cycles::BurstSign;
using cycles::CycleSource;

/// Returns the agreement of the signs, from -1, where all are opposite to the schedule, to 1, or nothing if there are
/// too few events.
std::optional<double> sign_agreement(const cycles::Schedule& schedule, std::span<const cycles::PatternEvents> events) {
  constexpr double kLeastSignedEvents = 500;
  double agreeing = 0, all = 0;
  for (size_t i = 0; i < schedule.size(); ++i) {
    const BurstSign sign = schedule.patterns[i].sign;
    if (sign == BurstSign::kAny) continue;
    const auto on = static_cast<double>(events[i].on), off = static_cast<double>(events[i].off);
    agreeing += sign == BurstSign::kOn ? on - off : off - on;
    all += on + off;
  }
  if (all < kLeastSignedEvents) return std::nullopt;
  return agreeing / all;
}

/// Returns the first pattern of `sign` that is followed by one of the opposite sign.
std::optional<size_t> find_extreme(const cycles::Schedule& schedule, BurstSign sign, BurstSign next_sign) {
  for (size_t i = 0; i < schedule.size(); ++i) {
    const BurstSign next = schedule.patterns[(i + 1) % schedule.size()].sign;
    if (schedule.patterns[i].sign == sign && next == next_sign) return i;
  }
  return std::nullopt;
}

/// Returns the ratio of the events between black and white to those between white and black, or nothing if the schedule
/// does not contain both.
std::optional<double> strength_after_black(const cycles::Schedule& schedule,
                                           std::span<const cycles::PatternEvents> events) {
  const auto black = find_extreme(schedule, BurstSign::kOff, BurstSign::kOn);
  const auto white = find_extreme(schedule, BurstSign::kOn, BurstSign::kOff);
  if (!black || !white) return std::nullopt;
  const auto between = [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = (begin + 1) % schedule.size(); i != end; i = (i + 1) % schedule.size()) {
      sum += static_cast<double>(events[i].on + events[i].off);
    }
    return sum;
  };
  return between(*black, *white) / std::max(between(*white, *black), 1.0);
}

}  // namespace

Polarity polarity_of(const cycles::Schedule& schedule, std::span<const cycles::PatternEvents> events) {
  constexpr double kLeastAgreement = 0.15;
  // Recordings synthesised from event images have artificial events in one half of the cycle, at most three times those
  // in the other.
  constexpr double kClearRatio = 4;
  const auto agreement = sign_agreement(schedule, events);
  if (!agreement || std::abs(*agreement) < kLeastAgreement) return Polarity::kUnknown;
  const bool agrees = *agreement > 0;
  const auto strength = strength_after_black(schedule, events);
  if (!strength || *strength > kClearRatio) return agrees ? Polarity::kRight : Polarity::kInverted;
  if (*strength < 1 / kClearRatio) return agrees ? Polarity::kInverted : Polarity::kHalfCycleOff;
  return Polarity::kUnknown;
}

bool is_doubtful(float confidence, CycleSource source) {
  // Bursts that are detected with certainty may exceed strong noise only slightly; correct times are well confirmed.
  constexpr float kDoubtfulBurst = 0.1F, kDoubtfulClaim = 0.3F;
  return confidence < (source == CycleSource::kBursts ? kDoubtfulBurst : kDoubtfulClaim);
}

void RigCheck::add(const recordings::EventBatch& batch) {
  diagnose::add(batch.triggers, inputs_);
  delay_.add_events(batch.events.t);
  // Duplicates are rarely single ones, so that a part of a long recording shows them.
  constexpr uint64_t kAllOfFirst = 16, kEvery = 32;
  if (batches_ < kAllOfFirst || batches_ % kEvery == 0) duplicates_.add(batch.events);
  ++batches_;
  if (!batch.events.empty()) {
    first_us_ = std::min(first_us_, batch.events.t.front());
    last_us_ = std::max(last_us_, batch.events.t.back());
  }
  if (!batch.triggers.empty()) {
    first_us_ = std::min(first_us_, batch.triggers.front().t);
    last_us_ = std::max(last_us_, batch.triggers.back().t);
  }
}

float RigCheck::add(const cycles::Cycle& cycle, const cycles::CycleOptions& options) {
  constexpr size_t kMostLate = 1000;
  if (!cycle.pattern_events.empty()) {
    polarity_ = polarity_of(options.schedule, cycle.pattern_events);
    ++polarities_[static_cast<size_t>(polarity_)];
    add_light(cycle);
    for (const cycles::PatternStart& start : cycle.starts) delay_.add_start(start.t_us);
  }
  constexpr uint64_t kMostSummed = 16;
  if (cycles_ < kMostSummed) {
    // At the beginning of a recording, the references of some pixels are far off, as those of hot ones always are.
    if (cycles_ == 1) sums_ = {};
    sums_.add(cycle.images);
    if (sums_.cycles == 1 || sums_.cycles == 4 || cycles_ + 1 == kMostSummed) {
      num_hot_ = capture::hot_pixels(sums_).size();
    }
  }
  std::vector<LateTrigger> late;
  if (options.source == CycleSource::kTriggers && !options.one_trigger_per_cycle) {
    late = late_.add(cycle, options.schedule);
  }
  num_late_ += late.size();
  if (late_triggers_.size() < kMostLate) late_triggers_.insert(late_triggers_.end(), late.begin(), late.end());
  const bool contradicts = polarity_ == Polarity::kInverted || polarity_ == Polarity::kHalfCycleOff;
  const float confidence = contradicts || !late.empty() ? 0.0F : cycle.confidence;
  ++cycles_;
  doubtful_ += is_doubtful(confidence, options.source);
  least_confidence_ = std::min(least_confidence_, confidence);
  return confidence;
}

void RigCheck::add_light(const cycles::Cycle& cycle) {
  const auto pixels = static_cast<double>(cycle.images.image_size());
  signed_per_pixel_.resize(cycle.pattern_events.size());
  for (size_t i = 0; i < signed_per_pixel_.size(); ++i) {
    const cycles::PatternEvents& events = cycle.pattern_events[i];
    signed_per_pixel_[i] += (static_cast<double>(events.on) - static_cast<double>(events.off)) / pixels;
  }
}

/// Returns the finding that the light is too low if the events do not confirm the times of most cycles, or contradict
/// their polarity, and no change of the patterns, not even that to white, causes an event on most pixels.
std::optional<Finding> RigCheck::check_light() const {
  constexpr double kLeastPerPixel = 0.6;
  const bool are_signs_right = cycles_of(Polarity::kInverted) + cycles_of(Polarity::kHalfCycleOff) == 0;
  if ((2 * doubtful_ <= cycles_ && are_signs_right) || signed_per_pixel_.empty()) return std::nullopt;
  double most = 0;
  for (const double sum : signed_per_pixel_) most = std::max(most, std::abs(sum));
  uint64_t judged = 0;
  for (const uint64_t cycles : polarities_) judged += cycles;
  most /= static_cast<double>(judged);
  if (most >= kLeastPerPixel) return std::nullopt;
  return Finding{"light-low",
                 Severity::kWarning,
                 cat("the light is so low that no change of the patterns causes more than ",
                     std::round(100 * most) / 100, " events per pixel, which confirm neither times nor polarity"),
                 "use more light, a wider aperture or more sensitive biases",
                 {{"events_per_pixel", most}, {"least_confidence", least_confidence_}}};
}

Findings RigCheck::findings(const cycles::CycleReader& reader) const {
  const cycles::CycleOptions& options = reader.options();
  const bool has_triggers_as_source = options.source == CycleSource::kTriggers;
  Findings findings;
  const auto add = [&](std::optional<Finding> finding) {
    const bool is_found = finding.has_value();
    if (is_found) findings.push_back(*std::move(finding));
    return is_found;
  };
  auto of_triggers = has_triggers_as_source ? check_triggers(inputs_, options, last_us_) : std::nullopt;
  const bool has_light = !add(check_light());
  // Patterns that are mistaken for others have other signs.
  if (!of_triggers && has_light) {
    add(check_inversion(options));
    add(check_halves(options));
  }
  add(check_late_triggers(options.schedule));
  if (has_triggers_as_source && has_light) add(check_delay(options));
  add(std::move(of_triggers));
  if (reader.report().has_assumed_first) {
    add(Finding{"first-pattern-assumed", Severity::kWarning,
                "neither intervals nor events determine which pattern the first trigger begins, and pattern 0 of "
                "the schedule is assumed",
                "give its number"}
            .about("first_pattern"));
  }
  add(check_pixels());
  add(check_duplicates());
  // A more certain reason explains it, but times that only the schedule states may be wrong in addition.
  const bool is_explained = contains(findings, "polarity-inverted") || contains(findings, "half-cycle-off");
  if (has_light && (!is_explained || options.source == CycleSource::kSchedule)) add(check_confidence());
  return findings;
}

std::optional<Finding> RigCheck::check_inversion(const cycles::CycleOptions& options) const {
  const uint64_t inverted = cycles_of(Polarity::kInverted);
  if (inverted == 0) return std::nullopt;
  return Finding{"polarity-inverted",
                 Severity::kError,
                 cat("the polarity is inverted in ", inverted, " of ", cycles_of_known_signs(),
                     " cycles: the change from black to the first pattern causes OFF events"),
                 options.invert_polarity ? "do not exchange ON and OFF events" : "exchange ON and OFF events",
                 {{"cycles", inverted}},
                 "invert_polarity"};
}

std::optional<Finding> RigCheck::check_halves(const cycles::CycleOptions& options) const {
  const uint64_t half_off = cycles_of(Polarity::kHalfCycleOff);
  if (half_off == 0) return std::nullopt;
  return Finding{
      "half-cycle-off",
      Severity::kError,
      cat("the patterns of ", half_off, " of ", cycles_of_known_signs(), " cycles are mistaken for their inverses"),
      "check with which pattern a cycle begins",
      {{"cycles", half_off}},
      cycles::option_of_first_pattern(options)};
}

std::optional<Finding> RigCheck::check_late_triggers(const cycles::Schedule& schedule) const {
  constexpr size_t kNamed = 3;
  if (num_late_ == 0) return std::nullopt;
  std::vector<std::string> named;
  Json each = Json::array();
  for (const LateTrigger& late : late_triggers_) {
    each.push_back({{"cycle", late.cycle}, {"pattern", late.pattern}, {"late_us", late.late_us}});
    if (named.size() == kNamed) continue;
    named.push_back(cat("cycle ", late.cycle, ", pattern ", late.pattern, " (", schedule.patterns[late.pattern].name,
                        "): ", std::abs(late.late_us), " us ", late.late_us > 0 ? "late" : "early"));
  }
  return Finding{"triggers-late",
                 Severity::kWarning,
                 cat(num_late_, num_late_ == 1 ? " trigger is" : " triggers are",
                     " out of step with the others, so that events were assigned to the wrong pattern (",
                     join(named, "; "), num_late_ > kNamed ? "; ..." : "", ")"),
                 "look for noise on the wire; the confidence of these cycles is 0",
                 {{"triggers", each}}};
}

std::optional<Finding> RigCheck::check_delay(const cycles::CycleOptions& options) const {
  // Pixels respond within a millisecond in bright light; triggers and displays differ by some tens of microseconds.
  constexpr int64_t kEarliestUs = -250, kLatestUs = 2'000;
  // The first events of most cameras follow the change of the pattern by about this time.
  constexpr int64_t kUsualUs = 200;
  const auto delay_us = delay_.delay_us();
  if (!delay_us || (*delay_us >= kEarliestUs && *delay_us <= kLatestUs)) return std::nullopt;
  const bool is_late = *delay_us < 0;
  const int64_t shift_us = options.trigger_delay_us + *delay_us - kUsualUs;
  return Finding{
      "trigger-delay",
      Severity::kError,
      cat("the events change ", std::abs(*delay_us), " us ", is_late ? "before" : "after",
          " the trigger of each pattern, so that some of them are assigned to the ", is_late ? "previous" : "next",
          " pattern"),
      cat("check whether the other edge is the right one, or give the delay of the display, about ", shift_us, " us"),
      {{"event_delay_us", *delay_us}, {"trigger_delay_us", shift_us}},
      "trigger_delay_us"};
}

std::optional<Finding> RigCheck::check_confidence() const {
  if (doubtful_ <= late_triggers_.size()) return std::nullopt;
  return Finding{"cycles-unconfirmed",
                 Severity::kWarning,
                 cat("the events of ", doubtful_, " of ", cycles_,
                     " cycles do not change when the patterns should have (least confidence ", least_confidence_, ")"),
                 "check the schedule, its origin and the first pattern, and look at the plot of the cycles",
                 {{"cycles", doubtful_}, {"least_confidence", least_confidence_}},
                 "schedule"};
}

std::optional<Finding> RigCheck::check_pixels() const {
  if (!are_many_hot(num_hot_, sums_.counts.image_size())) return std::nullopt;
  const double share = static_cast<double>(num_hot_) / static_cast<double>(sums_.counts.image_size());
  return Finding{"pixels-hot",
                 Severity::kWarning,
                 cat(num_hot_, " pixels (", std::round(1e4 * share) / 100,
                     " %) have far more events than their neighbours in each cycle, which spoils the result around "
                     "them, too"),
                 "give hot pixels the events of their neighbours",
                 {{"pixels", num_hot_}, {"share", share}},
                 "filter_pixels"};
}

std::optional<Finding> RigCheck::check_duplicates() const {
  constexpr double kLeastShare = 0.002;
  constexpr uint64_t kLeast = 100;
  const double share = duplicates_.share();
  if (duplicates_.duplicates() < kLeast || share < kLeastShare) return std::nullopt;
  return Finding{"events-duplicate",
                 Severity::kWarning,
                 cat(std::round(1000 * share) / 10, " % of the events are exact duplicates of others, and count twice"),
                 "look for packets that were sent twice or files that were joined, and remove them",
                 {{"share", share}}};
}

Json RigCheck::json(const cycles::CycleReader& reader) const {
  const cycles::CycleReport report = reader.report();
  Json dropped = Json::object();
  for (size_t i = 0; i < cycles::kNumCycleFaults; ++i) dropped[cycles::kCycleFaults[i].word] = report.dropped[i];
  const auto delay_us = delay_.delay_us();
  return {{"complete", report.complete},
          {"dropped", std::move(dropped)},
          {"marks", report.marks},
          {"unassigned_marks", report.unassigned_marks},
          {"events_given_up", report.events_given_up},
          {"silenced_pixels", report.hot_pixels},
          {"triggers", triggers_text(reader.schedule())},
          {"least_confidence", least_confidence_},
          {"event_delay_us", delay_us ? Json(*delay_us) : Json()},
          {"findings", to_json(findings(reader))}};
}

Finding RigCheck::no_cycle_finding(const cycles::CycleReader& reader) const {
  const cycles::CycleReport report = reader.report();
  const cycles::CycleOptions& options = reader.options();
  Finding none = Finding{"cycles-absent", Severity::kError, "no complete pattern cycle was found",
                         "check the source of the cycles, the schedule and the number of patterns"}
                     .about("source");
  std::optional<Finding> of_triggers;
  if (options.source == CycleSource::kTriggers) of_triggers = check_triggers(inputs_, options, last_us_);
  if (last_us_ == INT64_MIN) {
    none.code = "recording-empty";
    none.message += ": there are no events and no triggers in the time that was read";
    none.remedy = "compare the range of times with those that e2lf info states";
    none.option = "from_us";
  } else if (of_triggers) {
    none.code = of_triggers->code;
    none.message += cat(": ", of_triggers->message);
    none.remedy = of_triggers->remedy;
    none.option = of_triggers->option;
  } else if (options.source == CycleSource::kBursts && !inputs_.empty()) {
    none.message += ": the events do not show each change of pattern, but the recording has triggers";
    none.remedy = "use the triggers as the source";
  } else if (options.tracker.first_pattern && options.source != CycleSource::kSchedule) {
    none.message += cat(": no cycle begins with pattern ", *options.tracker.first_pattern);
    none.remedy = "omit this pattern, so that it is determined from the intervals and the events";
    none.option = "first_pattern";
  } else if (report.unassigned_marks > 0) {
    none.message +=
        cat(": ", report.unassigned_marks, " of ", report.marks, " triggers or bursts cannot be assigned to a pattern");
    none.remedy = "give the pattern of the first one";
    none.option = "first_pattern";
    if (options.source == CycleSource::kBursts) {
      none.remedy += ", or use the schedule as the source and give the time at which a cycle began";
    }
  }
  return none;
}

Finding no_trigger_finding(double seconds) {
  return Finding{"triggers-absent", Severity::kError, cat("there was no trigger within ", seconds, " s"),
                 "check the trigger cable, its level and the input"}
      .about("trigger_channel");
}

Findings check_camera(const recordings::RecordingReader& camera, uint64_t events, uint64_t triggers, double seconds) {
  const recordings::DecodeSummary summary = camera.summary();
  Findings findings;
  if (events == 0) {
    findings.push_back({"events-absent", Severity::kError, "the camera sent no events",
                        "take off the lens cap, and check the biases"});
  }
  if (triggers == 0) findings.push_back(no_trigger_finding(seconds));
  const auto check = [&](uint64_t lost, const char* code, const char* figure, std::string message, const char* remedy,
                         const char* option = "") {
    if (lost > 0) findings.push_back({code, Severity::kWarning, std::move(message), remedy, {{figure, lost}}, option});
  };
  const uint64_t dropped = summary.sensor_events_in - std::min(summary.sensor_events_in, summary.sensor_events_sent);
  check(dropped, "sensor-overloaded", "dropped",
        cat("the sensor dropped ", dropped, " of ", summary.sensor_events_in, " events"),
        "use less light, a smaller region or other biases", "roi");
  check(summary.live.dropped_bytes, "bytes-lost", "bytes",
        cat(summary.live.dropped_bytes, " bytes were lost because they arrived too fast"), "use a faster computer");
  check(summary.live.lost_buffers, "buffers-lost", "buffers",
        cat("the camera or its driver lost ", summary.live.lost_buffers, " buffers"),
        "check the cable and the load of the computer");
  check(summary.num_gaps, "times-with-gaps", "gaps",
        cat("the times have ", summary.num_gaps, " gaps, in which data are missing"),
        "check the cable and the load of the computer");
  for (const char* const filter : {"anti_flicker", "event_trail_filter"}) {
    if (camera.info().find(filter) != "on") continue;
    findings.push_back(Finding{"sensor-filter", Severity::kWarning,
                               cat("the filter ", filter, " is on and removes events of the patterns"),
                               "switch the filters of the sensor off"}
                           .about("no_sensor_filters"));
  }
  return findings;
}

}  // namespace e2lf::diagnose
