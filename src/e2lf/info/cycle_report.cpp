// SPDX-License-Identifier: MIT
#include "e2lf/info/cycle_report.h"

#include <algorithm>

#include "e2lf/base/format.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"

namespace e2lf::info {
namespace fs = std::filesystem;

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

}  // namespace

const char* source_name(cycles::CycleSource source) {
  switch (source) {
    case cycles::CycleSource::kTriggers:
      return "triggers";
    case cycles::CycleSource::kBursts:
      return "bursts";
    case cycles::CycleSource::kSchedule:
      return "schedule";
    case cycles::CycleSource::kAuto:
      break;
  }
  return "auto";
}

std::string report_text(const cycles::CycleReport& report) {
  std::string text = cat(counted(report.complete, "complete cycle"), dropped_text(report));
  if (report.hot_pixels > 0) text += cat(", ", report.hot_pixels, " pixels silenced");
  return text;
}

Error no_cycle_error(const fs::path& input, const diagnose::RigCheck& rig, const cycles::CycleReader& reader) {
  const diagnose::Finding finding = diagnose::no_cycle_finding(rig, reader);
  return {ErrorCode::kInvalidValue,
          cat(finding.code, ": ", diagnose::text_of(finding, "--"), " (", rig.triggers_text(reader.schedule()),
              dropped_text(reader.report()),
              "). `e2lf accumulate ... --plot cycles.svg` shows the event rate and the triggers"),
          input.string()};
}

Json report_json(const diagnose::RigCheck& rig, const cycles::CycleReader& reader) {
  const cycles::CycleReport report = reader.report();
  Json dropped = Json::object();
  for (size_t i = 0; i < cycles::kNumCycleFaults; ++i) {
    dropped[cycles::cycle_fault_name(static_cast<cycles::CycleFault>(i))] = report.dropped[i];
  }
  Json json = {{"complete", report.complete},
               {"dropped", dropped},
               {"marks", report.marks},
               {"unassigned_marks", report.unassigned_marks},
               {"events_given_up", report.events_given_up},
               {"silenced_pixels", report.hot_pixels}};
  json.update(rig.json(reader));
  return json;
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

}  // namespace e2lf::info
