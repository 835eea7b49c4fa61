// SPDX-License-Identifier: MIT
#include "e2lf/cycles/trigger_survey.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "e2lf/base/median.h"
#include "e2lf/base/text.h"

namespace e2lf::cycles {
namespace {

constexpr double kTolerance = 0.2;  // of an interval, as in PatternTracker

std::string ms(double us) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g ms", us / 1000);
  return text;
}

std::vector<double> intervals_of(const std::vector<int64_t>& times_us) {
  std::vector<double> intervals;
  for (size_t i = 1; i < times_us.size(); ++i) intervals.push_back(static_cast<double>(times_us[i] - times_us[i - 1]));
  return intervals;
}

std::vector<double> intervals_of(const Schedule& schedule) {
  std::vector<double> intervals;
  for (const ScheduledPattern& pattern : schedule.patterns) {
    intervals.push_back(static_cast<double>(pattern.interval_us()));
  }
  return intervals;
}

/// Returns the share of the intervals that match the expected ones, repeated and multiplied by `scale`, for the best
/// phase.
double fit(const std::vector<double>& intervals, const std::vector<double>& expected, double scale) {
  size_t best = 0;
  for (size_t phase = 0; phase < expected.size(); ++phase) {
    size_t fitting = 0;
    for (size_t i = 0; i < intervals.size(); ++i) {
      const double wanted = scale * expected[(phase + i) % expected.size()];
      fitting += std::abs(intervals[i] - wanted) <= kTolerance * wanted ? 1 : 0;
    }
    best = std::max(best, fitting);
  }
  return intervals.empty() ? 0 : static_cast<double>(best) / static_cast<double>(intervals.size());
}

/// Returns the ratio of the display's cycle to that of the schedule, assuming that the intervals repeat after one
/// cycle.
double scale_of(const std::vector<double>& intervals, const Schedule& schedule) {
  std::vector<double> cycles;
  for (size_t i = 0; i + schedule.size() <= intervals.size(); ++i) {
    double sum = 0;
    for (size_t k = 0; k < schedule.size(); ++k) sum += intervals[i + k];
    cycles.push_back(sum);
  }
  return median(cycles) / static_cast<double>(schedule.cycle_us());
}

constexpr double kMost = 0.9;  // share of the intervals that an explanation must match

/// Returns the intervals without those caused by a bouncing contact.
std::vector<double> without_bounces(const std::vector<int64_t>& times_us, double shortest_us) {
  std::vector<int64_t> kept;
  for (const int64_t t_us : times_us) {
    if (kept.empty() || static_cast<double>(t_us - kept.back()) > shortest_us) kept.push_back(t_us);
  }
  return intervals_of(kept);
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

/// Returns an explanation based on the times of one edge of one input, the most certain one first.
std::string advice_of_times(const std::vector<int64_t>& times_us, const Schedule& schedule, bool one_per_cycle) {
  const std::vector<double> intervals = intervals_of(times_us), expected = intervals_of(schedule);
  const double usual_us = median(intervals), cycle_us = static_cast<double>(schedule.cycle_us());
  const double shortest_us = *std::min_element(expected.begin(), expected.end());
  if (!one_per_cycle && std::abs(usual_us - cycle_us) <= kTolerance * cycle_us && schedule.size() > 1) {
    return cat("there is one trigger in ", ms(usual_us), ", which is a whole cycle; give --one-trigger-per-cycle");
  }
  if (one_per_cycle) {
    return cat("with --one-trigger-per-cycle a trigger is expected every ", ms(cycle_us), ", but one comes every ",
               ms(usual_us), "; leave the option out, or give the --schedule of the display");
  }
  if (fit(intervals, expected, 1.0) >= kMost) return "";
  const std::vector<double> calm = without_bounces(times_us, 0.3 * shortest_us);
  if (calm.size() + 1 < times_us.size() && fit(calm, expected, 1.0) >= kMost) {
    return cat("triggers come twice within ", ms(0.3 * shortest_us),
               ", as from a contact that bounces; smooth the signal, or select the clean edge with --edge");
  }
  for (const double scale : {scale_of(intervals, schedule), scale_of(calm, schedule)}) {
    if (scale > 0.05 && std::abs(scale - 1) > 0.02 && fit(intervals, expected, scale) >= kMost) {
      return cat("the intervals have the order of the schedule but are ", std::round(100 * scale) / 100,
                 " times as long: the display's cycle takes ", ms(scale * cycle_us), " and the schedule's ",
                 ms(cycle_us), "; give the display's durations with --schedule");
    }
  }
  std::vector<double> pairs;
  for (size_t i = 0; i < expected.size(); ++i) {
    pairs.push_back(expected[2 * i % expected.size()] + expected[(2 * i + 1) % expected.size()]);
  }
  std::vector<double> odd_pairs;
  for (size_t i = 0; i < expected.size(); ++i) {
    odd_pairs.push_back(expected[(2 * i + 1) % expected.size()] + expected[(2 * i + 2) % expected.size()]);
  }
  if (fit(intervals, pairs, 1.0) >= kMost || fit(intervals, odd_pairs, 1.0) >= kMost) {
    return "every second trigger is missing: the display may signal with each edge; give --edge both, or repair the "
           "signal";
  }
  for (size_t codes = 2; codes <= 64; ++codes) {
    const Schedule other = paper_schedule(codes);
    if (other.size() != schedule.size() && intervals.size() >= other.size() &&
        fit(intervals, intervals_of(other), 1.0) >= kMost) {
      return cat("the intervals are those of ", codes, " coding patterns; give --patterns ", codes);
    }
  }
  if (const size_t missing = missing_triggers(intervals, expected); missing > 0) {
    return cat(missing, " of ", times_us.size() + missing,
               " triggers are missing, and the others match the schedule; "
               "check the wire, the level and the length of the trigger pulses, or use --source bursts");
  }
  return cat("a trigger comes every ", ms(usual_us), " and the schedule has ", schedule.size(), " patterns in ",
             ms(cycle_us), "; give the display's --schedule");
}

const std::vector<int64_t>& times_of(const TriggerInput& input, const SurveyOptions& options) {
  return options.takes_rising ? input.rising_us : input.falling_us;
}

}  // namespace

void TriggerSurvey::add(std::span<const recordings::Trigger> triggers) {
  for (const recordings::Trigger& trigger : triggers) {
    TriggerInput& input = inputs_[trigger.id];
    ++(trigger.p != 0 ? input.rising : input.falling);
    auto& times_us = trigger.p != 0 ? input.rising_us : input.falling_us;
    if (times_us.size() < kMostTimes) times_us.push_back(trigger.t);
  }
}

std::string survey_text(const TriggerSurvey& survey, const Schedule& schedule) {
  std::vector<std::string> inputs;
  for (const auto& [id, input] : survey.inputs()) {
    const auto& times_us = input.rising >= input.falling ? input.rising_us : input.falling_us;
    inputs.push_back(cat("channel ", id, " has ", input.rising, " rising and ", input.falling, " falling edges",
                         times_us.size() > 1 ? cat(", mostly ", ms(median(intervals_of(times_us))), " apart") : ""));
  }
  return cat("triggers: ", inputs.empty() ? "none" : join(inputs, "; "), "; the schedule expects ", schedule.size(),
             " in ", ms(static_cast<double>(schedule.cycle_us())), ", mostly ", ms(median(intervals_of(schedule))),
             " apart");
}

std::string trigger_advice(const TriggerSurvey& survey, const Schedule& schedule, const SurveyOptions& options,
                           int64_t last_us) {
  const auto& inputs = survey.inputs();
  if (inputs.empty()) {
    return "the recording contains no triggers: enable the trigger input of the camera and check its cable, or use the "
           "events "
           "tell with --source bursts, which needs pixels that are faster than the patterns";
  }
  if (options.has_channel && !inputs.contains(options.channel)) {
    return cat("channel ", options.channel, " has no triggers; give --channel ", inputs.begin()->first);
  }
  if (!options.has_channel && inputs.size() > 1) {
    const auto* best = &*inputs.begin();
    double best_fit = -1;
    for (const auto& entry : inputs) {
      const double share = fit(intervals_of(times_of(entry.second, options)), intervals_of(schedule), 1.0);
      if (share > best_fit) best = &entry;
      best_fit = std::max(best_fit, share);
    }
    return cat(inputs.size(), " channels have triggers; give that of the patterns, probably --channel ", best->first);
  }
  const TriggerInput& input = options.has_channel ? inputs.at(options.channel) : inputs.begin()->second;
  if (options.takes_rising && !options.takes_falling && input.rising == 0) {
    return "there are only falling edges; give --edge falling";
  }
  if (options.takes_falling && !options.takes_rising && input.falling == 0) {
    return "there are only rising edges; give --edge rising";
  }
  if (options.takes_rising && options.takes_falling && input.rising > 0 && input.falling > 0) {
    for (const char* edge : {"rising", "falling"}) {
      const auto& times_us = edge[0] == 'r' ? input.rising_us : input.falling_us;
      if (advice_of_times(times_us, schedule, options.one_trigger_per_cycle).empty()) {
        return cat("each pattern has a rising and a falling edge; give --edge ", edge);
      }
    }
  }
  const auto& times_us = times_of(input, options);
  if (times_us.size() < schedule.size()) {
    return cat("there are ", times_us.size(), " triggers, and a cycle has ", schedule.size(),
               " patterns; record for longer, or give --one-trigger-per-cycle where each marks a cycle");
  }
  const std::string advice = advice_of_times(times_us, schedule, options.one_trigger_per_cycle);
  if (!advice.empty()) return advice;
  if (last_us - times_us.back() > 2 * schedule.cycle_us() && times_us.size() < TriggerSurvey::kMostTimes) {
    return cat("the triggers end ", ms(static_cast<double>(last_us - times_us.back())),
               " before the recording does; check the cable");
  }
  return "";
}

}  // namespace e2lf::cycles
