// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/rig_report.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/progress.h"
#include "e2lf/capture/measurement/hot_pixels.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/diagnose/event_order.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/model/composition.h"
#include "e2lf/pipeline/event_run.h"

namespace e2lf::pipeline {
namespace {

/// The first cycles of a rig.
struct FirstCycles {
  static constexpr size_t kMostSummed = 8;  // for the parallax, which noise hides in single cycles
  capture::EventImages first, sum;
  capture::CountSums counts;
  bool is_confirmed = true;

  void add(const CycleImages& cycle) {
    const capture::EventImages& images = cycle.images.events;
    if (counts.cycles == 0) {
      first = sum = images;
    } else if (counts.cycles < kMostSummed) {
      add_counts(images, sum);
    }
    counts.add(images);
    is_confirmed = is_confirmed && !(cycle.cycle && diagnose::is_doubtful(cycle.cycle->confidence, cycle.source));
  }
};

Result<FirstCycles> read_cycles(CycleInput& input) {
  FirstCycles cycles;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const std::optional<CycleImages> cycle, input.next());
    if (!cycle) return cycles;
    if (!capture::has_events(cycle->images.kind)) {
      return fail(ErrorCode::kUnsupported, "", "a rig is judged by its events; give a recording or event images");
    }
    cycles.add(*cycle);
  }
}

/// Returns the different patterns of the bundled models, by the name of the first one.
std::vector<std::pair<std::string, capture::Codes>> bundled_patterns() {
  std::vector<std::pair<std::string, capture::Codes>> patterns;
  std::vector<std::string> names = bundled_names(kBundledModels);
  std::ranges::stable_sort(names, {}, &std::string::size);  // e2lf-n4 before e2lf-n4-camera
  for (const std::string& name : names) {
    const auto path = bundled_file_named(kBundledModels, name);
    const auto stated = path ? model::read_stated_model(*path) : Result<model::StatedModel>(Error{});
    if (!stated || !stated->model.codes) continue;
    const capture::Codes codes = capture::codes_of_whole_cycle(*stated->model.codes).value_or(*stated->model.codes);
    const auto is_same = [&](const auto& known) { return known.second == codes; };
    if (std::ranges::none_of(patterns, is_same)) patterns.emplace_back(name, codes);
  }
  return patterns;
}

/// Opens the method for some patterns and judges the first cycle. Returns nothing if it does not compare them.
Result<std::optional<PatternFit>> fit_of(const std::string& name, MethodChoice choice, const CycleInput& input,
                                         const capture::EventImages& cycle, diagnose::Findings& findings) {
  E2LF_ASSIGN_OR_RETURN(
      ChosenMethod chosen,
      choose_method(std::move(choice), {}, input.is_recording() ? &input.reader().schedule() : nullptr));
  E2LF_ASSIGN_OR_RETURN(const auto check, FieldCheck::create(chosen.method, {}));
  if (!check) return std::optional<PatternFit>();
  E2LF_ASSIGN_OR_RETURN(auto explained, check->judge_events(cycle));
  if (!explained) return std::optional<PatternFit>();
  if (name.empty()) findings.insert(findings.end(), chosen.findings.begin(), chosen.findings.end());
  return std::optional(PatternFit{name, std::move(chosen.method), std::move(*explained)});
}

/// Judges the patterns that are stated, or else all bundled ones.
Result<void> add_fits(const MethodChoice& choice, const CycleInput& input, const capture::EventImages& cycle,
                      RigReport& report) {
  std::vector<std::pair<std::string, std::optional<capture::Codes>>> patterns = {{"", choice.codes}};
  if (!choice.model && !choice.codes && !choice.events.codes) {
    patterns.clear();
    for (auto& [name, codes] : bundled_patterns()) patterns.emplace_back(name, codes);
    report.is_confirmed = false;
  }
  for (const auto& [name, codes] : patterns) {
    if (stop_requested()) return {};
    MethodChoice with_patterns = choice;
    with_patterns.codes = codes;
    auto fit = fit_of(name, std::move(with_patterns), input, cycle, report.findings);
    if (fit && *fit) report.fits.push_back(std::move(**fit));
    if (!fit && stop_requested()) return {};
    if (!fit) report.no_network = fit.error();
  }
  std::ranges::sort(report.fits, {}, [](const PatternFit& fit) { return std::abs(std::log(fit.explained.ratio)); });
  if (!report.fits.empty()) report.no_network.reset();
  return {};
}

void add(const diagnose::Findings& more, diagnose::Findings& findings) {
  for (const diagnose::Finding& finding : more) {
    if (!diagnose::contains(findings, finding.code)) findings.push_back(finding);
  }
}

}  // namespace

std::string RigReport::verdict() const {
  if (diagnose::has_doubt(findings)) return "doubtful";
  return fits.empty() ? "unknown" : fits.front().explained.verdict(is_confirmed);
}

Result<RigReport> examine_rig(CycleInput& input, MethodChoice choice, const std::function<void()>& on_read) {
  E2LF_ASSIGN_OR_RETURN(const FirstCycles cycles, read_cycles(input));
  if (on_read) on_read();
  RigReport report{.cycles = cycles.counts.cycles, .is_confirmed = cycles.is_confirmed};
  if (input.is_recording()) {
    report.findings = report.cycles == 0 ? diagnose::Findings{diagnose::no_cycle_finding(input.rig(), input.reader())}
                                         : input.rig().findings(input.reader());
  }
  if (report.cycles == 0) return report;
  report.width = cycles.first.width;
  report.height = cycles.first.height;
  for (const int32_t count : cycles.counts.counts.values) report.events_per_pixel += std::abs(count);
  report.events_per_pixel /= static_cast<double>(cycles.first.image_size() * report.cycles);
  report.hot = capture::hot_pixels(cycles.counts).size();
  report.silent = capture::count_silent_pixels(cycles.counts);

  choice.measurement = capture::MeasurementKind::kEventImages;
  choice.transitions = input.transitions();
  E2LF_ASSIGN_OR_RETURN(choice.events, input.setup());
  E2LF_RETURN_IF_ERROR(add_fits(choice, input, cycles.first, report));
  const PatternFit* best = report.fits.empty() ? nullptr : &report.fits.front();
  add(diagnose::check_event_images(cycles.first), report.findings);
  if (best == nullptr) return report;
  // Wrong times explain every other order and orientation.
  if (cycles.is_confirmed) {
    const size_t summed = std::min(cycles.counts.cycles, FirstCycles::kMostSummed);
    if (auto other = diagnose::check_order(cycles.sum, summed, best->method.known_setup())) {
      add({*std::move(other)}, report.findings);
    }
    E2LF_ASSIGN_OR_RETURN(const auto check, FieldCheck::create(best->method, {}));
    auto found = search_rig(best->method, *check, best->explained, cycles.first, cycles.sum);
    if (!found && !stop_requested()) return found.error();
    if (found) {
      report.changes = std::move(found->changes);
      add(found->findings, report.findings);
    }
  }
  add(best->explained.findings, report.findings);
  return report;
}

}  // namespace e2lf::pipeline
