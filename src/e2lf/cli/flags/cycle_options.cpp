// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/cycle_options.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/flags/number_check.h"
#include "e2lf/cli/flags/option_types.h"
#include "e2lf/files/npy.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/open/open_named_recording.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// Returns true if the events of all transitions are used. Unless a network determines this, the patterns of the
/// recording do.
bool uses_all_transitions(const CycleFlags& flags, const cycles::Schedule& schedule, bool is_recorded_whole) {
  if (flags.transitions != "auto") return flags.transitions == "all";
  if (flags.num_wanted == schedule.num_images() + 1) return false;
  return is_recorded_whole || flags.num_wanted == schedule.size() + 1;
}

/// Returns the given schedule, or the paper's for the number of patterns that the recording states.
Result<cycles::Schedule> schedule_of(const CycleFlags& flags, const fs::path& input,
                                     const recordings::RecordingInfo& info) {
  constexpr size_t kFewest = 2;
  E2LF_ASSIGN_OR_RETURN(const capture::RecordedSetup setup, pipeline::recorded_setup(input, info));
  const auto of_whole = setup.codes ? capture::codes_of_whole_cycle(*setup.codes) : std::nullopt;
  const auto& shown = of_whole ? of_whole : setup.codes;
  cycles::Schedule schedule;
  if (!flags.schedule.empty()) {
    E2LF_ASSIGN_OR_RETURN(schedule, cycles::read_schedule(flags.schedule));
  } else {
    const size_t recorded = shown ? std::max(shown->num_patterns, kFewest) : flags.usual_patterns;
    schedule = cycles::paper_schedule(flags.num_patterns.value_or(recorded));
  }
  if (!uses_all_transitions(flags, schedule, of_whole.has_value())) return schedule;
  return with_all_transitions(std::move(schedule));
}

/// Returns the source that was given, or the one that other flags imply.
cycles::CycleSource source_of(const CycleFlags& flags) {
  if (flags.source == "triggers") return cycles::CycleSource::kTriggers;
  if (flags.source == "schedule") return cycles::CycleSource::kSchedule;
  if (flags.source == "bursts") return cycles::CycleSource::kBursts;
  if (flags.one_trigger_per_cycle || flags.channel) return cycles::CycleSource::kTriggers;
  return flags.origin_us ? cycles::CycleSource::kSchedule : cycles::CycleSource::kAuto;
}

cycles::TriggerEdge edge_of(const std::string& name) {
  if (name == "falling") return cycles::TriggerEdge::kFalling;
  return name == "both" ? cycles::TriggerEdge::kBoth : cycles::TriggerEdge::kRising;
}

}  // namespace

void add_cycle_options(CLI::App& app, CycleFlags& flags) {
  const std::string group = kCycleOptions;
  app.add_option("--source", flags.source,
                 "source of the times at which patterns change: triggers, bursts (the events), schedule, auto")
      ->check(CLI::IsMember({"auto", "triggers", "bursts", "schedule"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--schedule", flags.schedule,
                 "JSON: the patterns of a cycle and how long each is shown; default: the paper's")
      ->check(CLI::ExistingFile)
      ->group(group);
  app.add_option("--patterns", flags.num_patterns,
                 "number N of coding patterns of the paper's schedule; default: as the recording states, or else 4")
      ->check(whole_number(2, 64))
      ->group(group);
  app.add_option(
         "--transitions", flags.transitions,
         "event images of the changes to the active patterns a2 ... aN (lit), or of all changes of the whole "
         "cycle (all); auto selects all if the network or the patterns of the recording require it; reconstruct "
         "then uses the lit ones in cycles during which the scene moves too much")
      ->check(CLI::IsMember({"auto", "lit", "all"}))
      ->capture_default_str();
  app.add_option("--edge", flags.edge, "trigger edge: rising, falling, both")
      ->check(CLI::IsMember({"rising", "falling", "both"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--channel", flags.channel, "trigger input; default: all")->group(group);
  app.add_option("--first-pattern", flags.first_pattern,
                 "pattern of the first trigger or burst, from 0; default: determined from the intervals and the events")
      ->group(group);
  app.add_flag("--one-trigger-per-cycle", flags.one_trigger_per_cycle, "triggers mark cycles, not patterns")
      ->group(group);
  app.add_option("--origin-us", flags.origin_us,
                 "--source schedule: the time at which the first pattern of any cycle began")
      ->group(group);
  app.add_flag("--invert-polarity", flags.invert_polarity, "exchange ON and OFF events");
  app.add_flag("--filter-pixels", flags.filter_pixels, "ignore hot and flickering pixels")->group(group);
  app.add_option("--max-cycles", flags.max_cycles, "maximum number of complete cycles; 0 = all")->capture_default_str();
  add_recording_options(app, flags.recording, group);
}

Result<cycles::CycleOptions> cycle_options(const CycleFlags& flags, cycles::Schedule schedule) {
  cycles::CycleOptions options;
  options.schedule = std::move(schedule);
  options.source = source_of(flags);
  options.invert_polarity = flags.invert_polarity;
  options.edge = edge_of(flags.edge);
  options.channel = flags.channel;
  options.one_trigger_per_cycle = flags.one_trigger_per_cycle;
  options.tracker.first_pattern = flags.first_pattern;
  // Triggers are often set up to begin with the sequence, which does not hold for bursts.
  const bool may_be_triggers =
      options.source == cycles::CycleSource::kTriggers || options.source == cycles::CycleSource::kAuto;
  if (may_be_triggers) options.tracker.likely_first_pattern = 0;
  if (options.source == cycles::CycleSource::kSchedule && !flags.origin_us) {
    return Error{ErrorCode::kInvalidValue,
                 "the schedule does not state when a cycle began; give that time, or use the events (--source bursts)",
                 "--origin-us"};
  }
  options.origin_us = flags.origin_us.value_or(0);
  if (flags.filter_pixels) options.filter = cycles::PixelFilterOptions{};
  return options;
}

Result<cycles::CycleReader> open_cycles(const fs::path& input, const CycleFlags& flags, const CycleObserver& observer) {
  E2LF_ASSIGN_OR_RETURN(const recordings::OpenOptions open, open_options(input, flags.recording));
  E2LF_ASSIGN_OR_RETURN(auto reader, recordings::open_named_recording(input.string(), open));
  say_assumptions(*reader);
  E2LF_ASSIGN_OR_RETURN(cycles::Schedule schedule, schedule_of(flags, input, reader->info()));
  E2LF_ASSIGN_OR_RETURN(cycles::CycleOptions options, cycle_options(flags, std::move(schedule)));
  options.on_batch = observer.on_batch;
  options.on_mark = observer.on_mark;
  return cycles::CycleReader::open(std::move(reader), options);
}

const char* source_name(cycles::CycleSource source) {
  switch (source) {
    case cycles::CycleSource::kTriggers:
      return "triggers";
    case cycles::CycleSource::kSchedule:
      return "schedule";
    case cycles::CycleSource::kBursts:
      return "bursts";
    case cycles::CycleSource::kAuto:
      return "auto";
  }
  E2LF_REQUIRE(false, "a source without a name");
}

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
  std::string text = cat(report.complete, " complete cycle", report.complete == 1 ? "" : "s", dropped_text(report));
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

}  // namespace e2lf::cli
