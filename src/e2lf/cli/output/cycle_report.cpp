// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/cycle_report.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/output/print.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

bool is_doubtful(const cycles::Cycle& cycle, cycles::CycleSource source) {
  // Bursts that are detected with certainty may exceed strong noise only slightly; correct times are well confirmed.
  constexpr float kDoubtfulBurst = 0.1F, kDoubtfulClaim = 0.3F;
  return cycle.confidence < (source == cycles::CycleSource::kBursts ? kDoubtfulBurst : kDoubtfulClaim);
}

void ConfidenceWatch::add(const cycles::Cycle& cycle, cycles::CycleSource source) {
  ++cycles_;
  is_by_schedule_ = source == cycles::CycleSource::kSchedule;
  doubtful_ += is_doubtful(cycle, source);
  least_ = std::min(least_, cycle.confidence);
}

namespace {

/// Warns about cycles whose signs contradict the schedule, with the option that corrects this.
void warn_of_signs(const fs::path& input, const cycles::CycleReport& report) {
  if (report.inverted > 0) {
    log_warning(cat(
        input.string(), ": the polarity is inverted in ", report.inverted, " of ", report.complete,
        " cycles: the change from black to the first pattern causes OFF events; give --invert-polarity, or leave it "
        "out if it was given"));
  }
  if (report.half_cycle_off > 0) {
    log_warning(cat(input.string(), ": the patterns of ", report.half_cycle_off, " of ", report.complete,
                    " cycles are mistaken for their inverses; check --first-pattern and --origin-us"));
  }
}

/// Warns about triggers that are out of step, and names the first few.
void warn_of_late_edges(const fs::path& input, const cycles::CycleReport& report, const cycles::Schedule& schedule) {
  constexpr size_t kNamed = 3;
  if (report.late_edges.empty()) return;
  std::vector<std::string> named;
  for (const cycles::LateEdge& edge : report.late_edges) {
    if (named.size() == kNamed) break;
    named.push_back(cat("cycle ", edge.cycle, ", pattern ", edge.pattern, " (", schedule.patterns[edge.pattern].name,
                        "): ", std::abs(edge.late_us), " us ", edge.late_us > 0 ? "late" : "early"));
  }
  log_warning(
      cat(input.string(), ": ", report.late_edges.size(), " trigger", report.late_edges.size() == 1 ? " is" : "s are",
          " out of step with the others, so that events were assigned to the wrong pattern (", join(named, "; "),
          report.late_edges.size() > kNamed ? "; ..." : "", "); the confidence of these cycles is 0"));
}

/// Warns about triggers that are all late or early by the same time, as with the wrong edge.
void warn_of_onset(const fs::path& input, const cycles::CycleReport& report) {
  // Pixels respond within a millisecond in bright light; triggers and displays differ by some tens of microseconds.
  constexpr int64_t kEarliestUs = -250, kLatestUs = 2'000;
  if (!report.onset_us || (*report.onset_us >= kEarliestUs && *report.onset_us <= kLatestUs)) return;
  const bool is_late = *report.onset_us < 0;
  log_warning(
      cat(input.string(), ": the events change ", std::abs(*report.onset_us), " us ", is_late ? "before" : "after",
          " the trigger of each pattern, so that some of them are assigned to the ", is_late ? "previous" : "next",
          " pattern; check whether the other edge of the trigger is the right one ", "(--edge), or the trigger is too ",
          is_late ? "late" : "early"));
}

}  // namespace

void ConfidenceWatch::warn(const fs::path& input, const cycles::CycleReport& report,
                           const cycles::Schedule& schedule) const {
  // Patterns that are mistaken for others have other signs.
  if (report.advice.empty()) warn_of_signs(input, report);
  warn_of_late_edges(input, report, schedule);
  warn_of_onset(input, report);
  if (report.complete > 0 && !report.advice.empty()) {
    log_warning(cat(input.string(), ": ", report.advice));
  }
  if (report.has_assumed_first) {
    log_warning(cat(input.string(),
                    ": neither intervals nor events determine which pattern the first trigger begins: pattern ",
                    "0 of the schedule is assumed; give it with --first-pattern"));
  }
  // Times that only the schedule states may be wrong.
  const uint64_t explained = is_by_schedule_ ? 0 : report.inverted + report.half_cycle_off;
  if (doubtful_ <= explained || (explained == 0 && doubtful_ <= report.late_edges.size())) return;
  log_warning(cat(input.string(), ": the events of ", doubtful_, " of ", cycles_,
                  " cycles do not change when the patterns should have (least confidence ", least_,
                  "); check --schedule, --origin-us and --first-pattern, or look at `e2lf accumulate --plot`"));
}

namespace {

std::string dropped_text(const cycles::CycleReport& report) {
  std::string text;
  for (size_t i = 0; i < cycles::kNumCycleFaults; ++i) {
    if (report.dropped[i] == 0) continue;
    text +=
        cat(", ", report.dropped[i], " dropped (", cycles::cycle_fault_name(static_cast<cycles::CycleFault>(i)), ")");
  }
  return text;
}

/// Returns the text with a capital letter.
std::string sentence(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

}  // namespace

std::string report_text(const cycles::CycleReport& report) {
  std::string text = cat(counted(report.complete, "complete cycle"), dropped_text(report));
  if (report.hot_pixels > 0) text += cat(", ", report.hot_pixels, " pixels silenced");
  return text;
}

Error no_cycle_error(const fs::path& input, const cycles::CycleReport& report) {
  std::string advice = report.advice;
  if (advice.empty() && report.unassigned_marks > 0) {
    advice =
        cat(report.unassigned_marks, " of ", report.marks,
            " triggers or bursts cannot be assigned to a pattern; give the pattern of the first with --first-pattern");
  }
  if (advice.empty()) advice = "check --source, --schedule and --patterns";
  return {ErrorCode::kInvalidValue,
          cat("no complete pattern cycle was found", dropped_text(report), ". ", sentence(report.triggers), ". ",
              sentence(advice), ". `e2lf accumulate ... --plot cycles.svg` shows the event rate and the triggers"),
          input.string()};
}

Json report_json(const cycles::CycleReport& report) {
  Json dropped = Json::object();
  for (size_t i = 0; i < cycles::kNumCycleFaults; ++i) {
    dropped[cycles::cycle_fault_name(static_cast<cycles::CycleFault>(i))] = report.dropped[i];
  }
  Json late_edges = Json::array();
  for (const cycles::LateEdge& edge : report.late_edges) {
    late_edges.push_back({{"cycle", edge.cycle}, {"pattern", edge.pattern}, {"late_us", edge.late_us}});
  }
  return {{"complete", report.complete},
          {"dropped", dropped},
          {"marks", report.marks},
          {"unassigned_marks", report.unassigned_marks},
          {"triggers", report.triggers},
          {"inverted", report.inverted},
          {"half_cycle_off", report.half_cycle_off},
          {"onset_us", report.onset_us ? Json(*report.onset_us) : Json()},
          {"late_edges", late_edges},
          {"events_given_up", report.events_given_up},
          {"silenced_pixels", report.hot_pixels}};
}

Json cycle_json(const cycles::Cycle& cycle) {
  return {{"number", cycle.number},
          {"begin_us", cycle.begin_us},
          {"end_us", cycle.slices.empty() ? cycle.begin_us : cycle.slices.back().end_us},
          {"events", cycle.events},
          {"confidence", cycle.confidence}};
}

void LiveLog::add(uint64_t cycle, uint64_t events, double latency_s) {
  ++cycles_;
  events_ += events;
  sum_s_ += latency_s;
  most_s_ = std::max(most_s_, latency_s);
  log_info(cat("cycle ", cycle, ": ", events, " events, latency ", formatted("%.1f ms", 1e3 * latency_s)));
}

void LiveLog::finish(const cycles::CycleReport& report) const {
  if (cycles_ == 0) return;
  log_info(cat(
      "live input ended: ", report_text(report), "; ", events_, " events; latency ",
      formatted("%.1f ms on average, %.1f ms at most", 1e3 * sum_s_ / static_cast<double>(cycles_), 1e3 * most_s_)));
}

}  // namespace e2lf::cli
