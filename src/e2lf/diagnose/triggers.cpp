// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/triggers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "e2lf/base/median.h"
#include "e2lf/base/text.h"

namespace e2lf::diagnose {
namespace {

constexpr int64_t kBinUs = 100;
constexpr int64_t kSmoothedBins = 5;  // on either side of a rise
constexpr int64_t kMostReachUs = 5'000;
constexpr double kChanceShare = 0.02;   // of the largest rate
constexpr uint64_t kLeastEvents = 200;  // after the rise
constexpr double kFirstShare = 0.05;    // of the events after the rise, in the first bin
constexpr uint64_t kClearFactor = 2;    // ratio of the events after the rise to those before it
constexpr size_t kMostCounted = 8192;   // events per call

}  // namespace

void EventDelay::add_events(std::span<const int64_t> times_us) {
  if (times_us.empty()) return;
  if (!first_us_) {
    first_us_ = times_us.front();
    counts_.resize(kWatchedUs / kBinUs);
  }
  if (times_us.front() >= *first_us_ + kWatchedUs) return;
  // A subset is sufficient if there are many events.
  const size_t stride = std::max<size_t>(times_us.size() / kMostCounted, 1);
  for (size_t i = 0; i < times_us.size(); i += stride) {
    const auto bin = static_cast<uint64_t>(times_us[i] - *first_us_) / static_cast<uint64_t>(kBinUs);
    if (bin >= counts_.size()) break;
    counts_[bin] += static_cast<uint32_t>(stride);
  }
}

void EventDelay::add_start(int64_t t_us) {
  if (starts_us_.empty() || t_us < starts_us_.front() + kWatchedUs) starts_us_.push_back(t_us);
}

std::vector<uint64_t> EventDelay::profile(int64_t reach_us) const {
  const int64_t bins = reach_us / kBinUs + kSmoothedBins;
  std::vector<uint64_t> sums(static_cast<size_t>(2 * bins));
  for (const int64_t start_us : starts_us_) {
    const int64_t begin = (start_us - *first_us_) / kBinUs - bins;
    if (start_us < *first_us_ || begin < 0 || begin + 2 * bins > static_cast<int64_t>(counts_.size())) continue;
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += counts_[static_cast<size_t>(begin) + i];
  }
  return sums;
}

std::optional<int64_t> EventDelay::delay_us() const {
  if (!first_us_ || starts_us_.size() < kMinStarts) return std::nullopt;
  int64_t reach_us = kMostReachUs;
  for (size_t i = 1; i < starts_us_.size(); ++i) {
    reach_us = std::min(reach_us, (starts_us_[i] - starts_us_[i - 1]) / 2);
  }
  const std::vector<uint64_t> events = profile(reach_us);
  const auto sum = [&](size_t first) {
    uint64_t all = 0;
    for (size_t bin = first; bin < first + kSmoothedBins; ++bin) all += events[bin];
    return all;
  };
  // With slow pixels, the rate rises gradually; the first events are where it rises most relative to the previous rate.
  uint64_t most = 0;
  for (size_t bin = 0; bin + kSmoothedBins <= events.size(); ++bin) most = std::max(most, sum(bin));
  const double least = kChanceShare * static_cast<double>(most) + 1.0;  // smaller counts are chance
  size_t best = 0;
  double best_rise = 0;
  for (size_t bin = kSmoothedBins; bin + kSmoothedBins <= events.size(); ++bin) {
    const double rise =
        (static_cast<double>(sum(bin)) + least) / (static_cast<double>(sum(bin - kSmoothedBins)) + least);
    if (rise > best_rise) {
      best = bin;
      best_rise = rise;
    }
  }
  if (best == 0) return std::nullopt;
  const uint64_t behind = sum(best), before = sum(best - kSmoothedBins);
  if (behind < kLeastEvents || behind < kClearFactor * before) return std::nullopt;
  // Events of one time rise equally in all windows that contain them.
  while (static_cast<double>(events[best]) < kFirstShare * static_cast<double>(behind)) ++best;
  return (static_cast<int64_t>(best) - static_cast<int64_t>(events.size() / 2)) * kBinUs;
}

namespace {

constexpr double kTolerance = 0.2;  // of an interval, as in PatternTracker
constexpr double kMost = 0.9;       // share of the intervals that an explanation must match

std::string ms(double us) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g ms", us / 1000);
  return text;
}

Finding finding(const char* code, std::string message, std::string remedy, const char* option = "", Json figures = {}) {
  return {code, Severity::kError, std::move(message), std::move(remedy), std::move(figures), option};
}

std::vector<double> intervals_of(const std::vector<int64_t>& times_us) {
  std::vector<double> intervals;
  for (size_t i = 1; i < times_us.size(); ++i) intervals.push_back(static_cast<double>(times_us[i] - times_us[i - 1]));
  return intervals;
}

std::vector<double> intervals_of(const cycles::Schedule& schedule) {
  std::vector<double> intervals;
  for (const auto& pattern : schedule.patterns) intervals.push_back(static_cast<double>(pattern.interval_us()));
  return intervals;
}

/// Returns the share of the intervals that match the expected ones, repeated and multiplied by `scale`, for the best
/// phase.
double matching_share(const std::vector<double>& intervals, const std::vector<double>& expected, double scale = 1) {
  size_t best = 0;
  for (size_t phase = 0; phase < expected.size(); ++phase) {
    size_t matching = 0;
    for (size_t i = 0; i < intervals.size(); ++i) {
      const double wanted = scale * expected[(phase + i) % expected.size()];
      matching += std::abs(intervals[i] - wanted) <= kTolerance * wanted ? 1 : 0;
    }
    best = std::max(best, matching);
  }
  return intervals.empty() ? 0 : static_cast<double>(best) / static_cast<double>(intervals.size());
}

/// Returns the ratio of the display's cycle to that of the schedule, if the intervals repeat after one cycle.
double scale_of(const std::vector<double>& intervals, const cycles::Schedule& schedule) {
  std::vector<double> cycles;
  for (size_t i = 0; i + schedule.size() <= intervals.size(); ++i) {
    double sum = 0;
    for (size_t k = 0; k < schedule.size(); ++k) sum += intervals[i + k];
    cycles.push_back(sum);
  }
  return median(cycles) / static_cast<double>(schedule.cycle_us());
}

/// Returns the intervals between every second trigger of the schedule, beginning with its trigger `first`.
std::vector<double> pairs_of(const std::vector<double>& expected, size_t first) {
  std::vector<double> pairs;
  for (size_t i = first; i < first + 2 * expected.size(); i += 2) {
    pairs.push_back(expected[i % expected.size()] + expected[(i + 1) % expected.size()]);
  }
  return pairs;
}

/// Returns how many triggers are missing if each interval is one of the schedule or the sum of several consecutive
/// ones, for the best phase; 0 if intervals are left unexplained, or if fewer than half of them are single ones.
size_t missing_triggers(const std::vector<double>& intervals, const std::vector<double>& expected) {
  auto most_explained = static_cast<size_t>(std::ceil(kMost * static_cast<double>(intervals.size())));
  size_t found = 0;
  for (size_t phase = 0; phase < expected.size(); ++phase) {
    size_t place = phase, single = 0, explained = 0, missing = 0;
    for (const double interval : intervals) {
      double sum = 0, tolerance = 0;
      size_t steps = 0;
      while (sum + tolerance < interval && steps < 2 * expected.size()) {
        const double next = expected[(place + steps++) % expected.size()];
        sum += next;
        tolerance = kTolerance * next;
      }
      place += std::max<size_t>(steps, 1);
      if (std::abs(sum - interval) > tolerance) continue;
      ++explained;
      single += steps == 1 ? 1 : 0;
      missing += steps - 1;
    }
    if (explained < most_explained || 2 * single < intervals.size()) continue;
    most_explained = explained + 1;
    found = missing;
  }
  return found;
}

/// Returns how many triggers are additional ones if each interval of the schedule is one between triggers or the sum of
/// several consecutive ones, for the best phase; 0 if intervals are left unexplained, or if there are more than one in
/// four.
size_t extra_triggers(const std::vector<double>& intervals, const std::vector<double>& expected) {
  size_t fewest = 0;
  for (size_t phase = 0; phase < expected.size(); ++phase) {
    size_t place = phase, extra = 0, explained = 0;
    double sum = 0;
    for (const double interval : intervals) {
      const double wanted = expected[place % expected.size()], tolerance = kTolerance * wanted;
      sum += interval;
      if (sum < wanted - tolerance) {
        ++extra;
        continue;
      }
      explained += std::abs(sum - wanted) <= tolerance ? 1 : 0;
      ++place;
      sum = 0;
    }
    const bool is_explained = static_cast<double>(explained) >= kMost * static_cast<double>(intervals.size() - extra);
    if (is_explained && 4 * extra < intervals.size() && (fewest == 0 || extra < fewest)) fewest = extra;
  }
  return fewest;
}

/// Returns the times without those that cycles::PatternTracker ignores.
std::vector<int64_t> without_bounces(const std::vector<int64_t>& times_us, double shortest_us) {
  std::vector<int64_t> kept;
  for (const int64_t t_us : times_us) {
    if (kept.empty() || static_cast<double>(t_us - kept.back()) >= cycles::kBounceShare * shortest_us)
      kept.push_back(t_us);
  }
  return kept;
}

/// Returns the finding that some of the triggers are additional ones; nothing if none is.
std::optional<Finding> extra_finding(size_t bounces, size_t others, size_t triggers) {
  if (bounces + others == 0) return std::nullopt;
  Finding found = finding(
      "triggers-extra",
      cat(bounces + others, " of ", triggers, " triggers are additional ones, and the others match the schedule; ",
          others == 0 ? "they follow another at once and are ignored"
                      : "those that follow another at once are ignored, and cycles with others are left out"),
      "look for noise or a bouncing contact on the wire", "", {{"extra", bounces + others}});
  found.severity = Severity::kWarning;
  return found;
}

/// Explains the times of one edge of one input, by the most certain reason first.
std::optional<Finding> check_times(const std::vector<int64_t>& all_us, const cycles::Schedule& schedule,
                                   bool is_one_per_cycle) {
  const std::vector<double> expected = intervals_of(schedule);
  const std::vector<int64_t> times_us =
      without_bounces(all_us, is_one_per_cycle ? static_cast<double>(schedule.cycle_us()) : std::ranges::min(expected));
  const size_t bounces = all_us.size() - times_us.size();
  const std::vector<double> intervals = intervals_of(times_us);
  const double usual_us = median(intervals), cycle_us = static_cast<double>(schedule.cycle_us());
  const bool are_cycles = std::abs(usual_us - cycle_us) <= kTolerance * cycle_us;
  const Json figures = {{"interval_us", usual_us}, {"cycle_us", cycle_us}};
  if (is_one_per_cycle) {
    if (are_cycles) return extra_finding(bounces, 0, all_us.size());
    return finding(
        "triggers-of-patterns",
        cat("one trigger per cycle is expected, every ", ms(cycle_us), ", but one comes every ", ms(usual_us)),
        "expect one trigger per pattern, or give the schedule of the display", "one_trigger_per_cycle", figures);
  }
  if (are_cycles && schedule.size() > 1) {
    return finding("triggers-of-cycles", cat("there is one trigger in ", ms(usual_us), ", which is a whole cycle"),
                   "expect one trigger per cycle", "one_trigger_per_cycle", figures);
  }
  if (matching_share(intervals, expected) >= kMost) return extra_finding(bounces, 0, all_us.size());
  if (const double scale = scale_of(intervals, schedule);
      scale > 0.05 && std::abs(scale - 1) > 0.02 && matching_share(intervals, expected, scale) >= kMost) {
    return finding(
        "schedule-scaled",
        cat("the intervals between triggers have the order of the schedule but are ", std::round(100 * scale) / 100,
            " times as long: the display's cycle takes ", ms(scale * cycle_us), " and the schedule's ", ms(cycle_us)),
        "give a schedule with the durations of the display", "schedule", {{"scale", scale}});
  }
  if (std::max(matching_share(intervals, pairs_of(expected, 0)), matching_share(intervals, pairs_of(expected, 1))) >=
      kMost) {
    return finding("triggers-halved",
                   "every second trigger is missing: the display may change its output at each pattern",
                   "use both edges, or repair the signal", "edge", figures);
  }
  if (const size_t missing = missing_triggers(intervals, expected); missing > 0) {
    return finding(
        "triggers-missing",
        cat(missing, " of ", times_us.size() + missing, " triggers are missing, and the others match the schedule"),
        "check the wire, the level and the length of the trigger pulses", "", {{"missing", missing}});
  }
  if (const size_t extra = extra_triggers(intervals, expected); extra > 0) {
    return extra_finding(bounces, extra, all_us.size());
  }
  return finding("schedule-other",
                 cat("a trigger comes every ", ms(usual_us), ", and the schedule has ", schedule.size(),
                     " patterns in ", ms(cycle_us)),
                 "give the schedule of the display, or the number of its coding patterns", "schedule", figures);
}

/// Returns the times of the edges that are used, in order.
std::vector<int64_t> times_of(const TriggerInput& input, cycles::TriggerEdge edge) {
  if (edge != cycles::TriggerEdge::kBoth) {
    return edge == cycles::TriggerEdge::kFalling ? input.falling.times_us : input.rising.times_us;
  }
  std::vector<int64_t> times_us;
  std::ranges::merge(input.rising.times_us, input.falling.times_us, std::back_inserter(times_us));
  return times_us;
}

/// Returns the input whose triggers match the schedule best.
uint16_t best_input(const TriggerInputs& inputs, const cycles::CycleOptions& options) {
  const auto* best = &*inputs.begin();
  double best_share = -1;
  for (const auto& entry : inputs) {
    const double share =
        matching_share(intervals_of(times_of(entry.second, options.edge)), intervals_of(options.schedule));
    if (share > best_share) best = &entry;
    best_share = std::max(best_share, share);
  }
  return best->first;
}

}  // namespace

void add(std::span<const recordings::Trigger> triggers, TriggerInputs& inputs) {
  for (const recordings::Trigger& trigger : triggers) {
    TriggerEdges& edges = trigger.p != 0 ? inputs[trigger.id].rising : inputs[trigger.id].falling;
    ++edges.count;
    edges.last_us = trigger.t;
    if (edges.times_us.size() < TriggerEdges::kMostTimes) edges.times_us.push_back(trigger.t);
  }
}

Json to_json(const TriggerInputs& inputs) {
  Json json = Json::array();
  for (const auto& [id, input] : inputs) {
    json.push_back({{"channel", id},
                    {"rising", input.rising.count},
                    {"falling", input.falling.count},
                    {"rising_period_us", input.rising.period_us()},
                    {"falling_period_us", input.falling.period_us()}});
  }
  return json;
}

std::string triggers_text(const TriggerInputs& inputs, const cycles::Schedule& schedule) {
  std::vector<std::string> texts;
  for (const auto& [id, input] : inputs) {
    const auto& times_us = (input.rising.count >= input.falling.count ? input.rising : input.falling).times_us;
    texts.push_back(cat("channel ", id, " has ", input.rising.count, " rising and ", input.falling.count,
                        " falling edges",
                        times_us.size() > 1 ? cat(", mostly ", ms(median(intervals_of(times_us))), " apart") : ""));
  }
  return cat("triggers: ", texts.empty() ? "none" : join(texts, "; "), "; the schedule expects ", schedule.size(),
             " in ", ms(static_cast<double>(schedule.cycle_us())), ", mostly ", ms(median(intervals_of(schedule))),
             " apart");
}

std::optional<Finding> check_triggers(const TriggerInputs& inputs, const cycles::CycleOptions& options,
                                      int64_t last_us) {
  if (inputs.empty()) {
    return finding("triggers-absent", "the recording contains no triggers",
                   "enable the trigger input of the camera and check its cable; pixels that are faster than the "
                   "patterns also permit bursts of events as the source",
                   "source");
  }
  if (options.channel && !inputs.contains(*options.channel)) {
    return finding("trigger-channel", cat("channel ", *options.channel, " has no triggers"),
                   cat("use channel ", inputs.begin()->first), "channel");
  }
  if (!options.channel && inputs.size() > 1) {
    return finding("trigger-channel", cat(inputs.size(), " channels have triggers"),
                   cat("use that of the patterns, probably channel ", best_input(inputs, options)), "channel");
  }
  using cycles::TriggerEdge;
  const TriggerInput& input = options.channel ? inputs.at(*options.channel) : inputs.begin()->second;
  if (options.edge == TriggerEdge::kRising && input.rising.count == 0) {
    return finding("trigger-edge", "there are only falling edges", "use the falling edges", "edge");
  }
  if (options.edge == TriggerEdge::kFalling && input.falling.count == 0) {
    return finding("trigger-edge", "there are only rising edges", "use the rising edges", "edge");
  }
  const std::vector<int64_t> times_us = times_of(input, options.edge);
  if (options.edge == TriggerEdge::kBoth && input.falling.count > 0) {
    const auto of_rising = check_times(input.rising.times_us, options.schedule, options.one_trigger_per_cycle);
    if (!of_rising || of_rising->code == "triggers-extra") {  // bounces do not hide what the rising edges are
      return finding("trigger-edge", "each pattern has a rising and a falling edge", "use the rising edges", "edge");
    }
  }
  constexpr size_t kEnoughOfCycles = 3;
  if (!options.one_trigger_per_cycle && times_us.size() < options.schedule.size()) {
    auto of_cycles = check_times(times_us, options.schedule, options.one_trigger_per_cycle);
    if (times_us.size() >= kEnoughOfCycles && of_cycles && of_cycles->code == "triggers-of-cycles") return of_cycles;
    return finding("triggers-few",
                   cat("the recording has fewer triggers (", times_us.size(), ") than a cycle has patterns (",
                       options.schedule.size(), ")"),
                   "record for longer, or state that each marks a cycle", "one_trigger_per_cycle");
  }
  if (auto found = check_times(times_us, options.schedule, options.one_trigger_per_cycle)) return found;
  if (last_us - times_us.back() > 2 * options.schedule.cycle_us() && times_us.size() < TriggerEdges::kMostTimes) {
    return finding(
        "triggers-end",
        cat("the triggers end ", ms(static_cast<double>(last_us - times_us.back())), " before the recording"),
        "check the cable");
  }
  return std::nullopt;
}

double LateTriggerFinder::expected_us(size_t pattern, const cycles::Schedule& schedule) const {
  constexpr size_t kEnough = 3;  // with fewer, the schedule is used
  const auto known = intervals_us_.find(pattern);
  if (known == intervals_us_.end() || known->second.size() < kEnough) {
    return static_cast<double>(schedule.patterns[pattern].interval_us());
  }
  return median(std::vector<double>(known->second.begin(), known->second.end()));
}

std::vector<LateTrigger> LateTriggerFinder::add(const cycles::Cycle& cycle, const cycles::Schedule& schedule) {
  constexpr size_t kRemembered = 7;     // number of intervals whose median is the expected one
  constexpr double kLeastLateUs = 150;  // displays and clocks have a jitter of about 10 us
  constexpr double kLeastShare = 0.02;  // relative to an interval
  if (cycle.number != std::exchange(next_cycle_, cycle.number + 1)) before_.reset();
  std::vector<LateTrigger> late;
  for (size_t i = 0; i < cycle.starts.size(); ++i) {
    const cycles::PatternStart& start = cycle.starts[i];
    const int64_t end_us = i + 1 < cycle.starts.size() ? cycle.starts[i + 1].t_us : cycle.end_us;
    const auto interval_us = static_cast<double>(end_us - start.t_us);
    if (before_) {
      const double first_us = expected_us(before_->pattern, schedule), second_us = expected_us(start.pattern, schedule);
      const double longer_us = static_cast<double>(start.t_us - before_->t_us) - first_us;
      const double shorter_us = second_us - interval_us, late_us = 0.5 * (longer_us + shorter_us);
      const double least_us = std::max(kLeastLateUs, kLeastShare * std::min(first_us, second_us));
      if (std::abs(late_us) > least_us && std::abs(longer_us - shorter_us) < 0.5 * std::abs(late_us)) {
        late.push_back({cycle.number, start.pattern, static_cast<int64_t>(std::llround(late_us))});
      }
    }
    auto& known = intervals_us_[start.pattern];
    known.push_back(interval_us);
    if (known.size() > kRemembered) known.pop_front();
    before_ = start;
  }
  return late;
}

}  // namespace e2lf::diagnose
