// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/rig_report.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/hot_pixels.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/diagnose/event_order.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/model/composition.h"
#include "e2lf/pipeline/event_run.h"

namespace e2lf::pipeline {
using diagnose::Finding;
using diagnose::middle_of;
using diagnose::OtherOrientation;
using diagnose::Severity;
namespace {

// docs/experiments/findings.md states how often these thresholds are wrong.
constexpr double kCameraRatio = 1.2;    // ratio of the error to that with the network's camera
constexpr double kChangedRatio = 0.97;  // ratio of the error of changed events to that of the given ones
constexpr double kClearRatio = 0.8;     // the same if the given events are explained as well as noise permits
constexpr double kLeastExplained = 0.95, kMostExplained = 1.005;     // range of `ratio` for correct events
constexpr size_t kMostSideSearched = 512, kMostSideOfChanged = 192;  // px

/// Turns or mirrors square images as patterns would: a pattern that is mirrored on the aperture has the same effect as
/// an unmirrored one on the mirrored scene.
capture::EventImages oriented(const capture::EventImages& events, const OtherOrientation& to) {
  const size_t side = events.width;
  const auto along = [side](int of_y, int of_x, size_t y, size_t x) {
    const size_t place = of_y != 0 ? y : x;
    return of_y + of_x > 0 ? place : side - 1 - place;
  };
  capture::EventImages result(events.count, side, side);
  for (size_t k = 0; k < events.count; ++k) {
    for (size_t i = 0; i < events.image_size(); ++i) {
      const size_t y = along(to.y_of_y, to.y_of_x, i / side, i % side);
      const size_t x = along(to.x_of_y, to.x_of_x, i / side, i % side);
      result.image(k)[i] = events.image(k)[y * side + x];
    }
  }
  return result;
}

/// A possible mistake of the rig, as the change of the events that undoes it.
struct Change {
  const char* code;
  std::string name, remedy, option;
  std::function<capture::EventImages(const capture::EventImages&)> apply;
};

std::vector<Change> changes_of(size_t transitions) {
  std::vector<Change> changes;
  for (const diagnose::EventChange& change : diagnose::event_changes(transitions)) {
    changes.push_back({change.code, change.name, change.remedy, change.option,
                       [change](const capture::EventImages& events) { return change.apply(events); }});
  }
  for (const OtherOrientation& other : diagnose::kOtherOrientations) {
    changes.push_back({"orientation-better-changed", other.name, other.remedy, "",
                       [&other](const capture::EventImages& images) { return oriented(images, other); }});
  }
  return changes;
}

Result<double> error_of(const recon::Method& method, const recon::EventCheck& check,
                        const capture::EventImages& events) {
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, method(events, {}));
  E2LF_ASSIGN_OR_RETURN(const recon::EventError error, recon::event_error(check, light_field, 1.0F, events));
  return error.least;
}

/// A mistake that would explain the events better than none, and whether by so much that nothing else need explain it.
struct BetterChange {
  Finding finding;
  bool is_clear = false;
};

/// Returns the mistake that would explain the events better than none, if there is one, and adds what was tried. One
/// correct scene in twenty is explained slightly better in another order, so that a clear difference is required if the
/// events are explained as well as their noise allows.
Result<std::optional<BetterChange>> better_change(const FieldCheck& check, const Explanation& explained,
                                                  const capture::EventImages& events, Json& tried) {
  const size_t side = std::min({events.height, events.width, kMostSideOfChanged});
  const recon::EventCheck own =
      in_window(check.camera(), static_cast<double>(side) / static_cast<double>(events.width));
  const capture::EventImages given = middle_of(events, side, side);
  E2LF_ASSIGN_OR_RETURN(const double unchanged, error_of(check.method(), own, given));
  if (unchanged == 0) return std::optional<BetterChange>();  // nothing explains the events better
  const std::vector<Change> changes = changes_of(events.count);
  const Change* best = nullptr;
  double least = 0;
  for (const Change& change : changes) {
    if (stop_requested()) return std::optional<BetterChange>();
    E2LF_ASSIGN_OR_RETURN(const double error, error_of(check.method(), own, change.apply(given)));
    tried[change.name] = error / unchanged;
    if (best != nullptr && error >= least) continue;
    best = &change;
    least = error;
  }
  const bool is_explained = explained.ratio >= kLeastExplained && explained.ratio <= kMostExplained;
  if (best == nullptr || least >= (is_explained ? kClearRatio : kChangedRatio) * unchanged) {
    return std::optional<BetterChange>();
  }
  const auto rounded = [](double value) { return std::round(1000 * value) / 1000; };
  Finding finding{best->code,
                  Severity::kError,
                  cat("the events are explained better ", best->name, ": the light field differs from them by ",
                      rounded(least), " instead of ", rounded(unchanged)),
                  best->remedy,
                  {{"error", least}, {"unchanged_error", unchanged}, {"change", best->name}},
                  best->option};
  // The parallax is more sensitive to the patterns, and independent of the polarity and the order of event images.
  const bool is_clear = finding.option == "invert_polarity" || least < kClearRatio * unchanged;
  return std::optional(BetterChange{std::move(finding), is_clear});
}

/// Returns the finding that the camera of the network explains the events much better than the one that was given.
Result<std::optional<Finding>> worse_camera(const OpenedMethod& method, const FieldCheck& check,
                                            const Explanation& explained, const capture::EventImages& events) {
  if (!method.models_camera) return std::optional<Finding>();
  const capture::EventImages given = middle_of(events, kMostSideSearched, kMostSideSearched);
  recon::EventCheck models = check.camera();
  models.pixels = method.models_camera;
  const auto network = std::make_shared<const recon::Reconstructor>(method.network->with_camera(*method.models_camera));
  const double share_of_width = static_cast<double>(given.width) / static_cast<double>(events.width);
  E2LF_ASSIGN_OR_RETURN(const double other, error_of(method_of(network, {.cycles = models.cycles}),
                                                     in_window(models, share_of_width), given));
  if (explained.error <= kCameraRatio * other) return std::optional<Finding>();
  return std::optional(Finding{"camera-worse",
                               Severity::kError,
                               cat("the camera that was given explains the events much worse than the one for which "
                                   "the network was trained: the light field differs from them by ",
                                   explained.error, " instead of ", other),
                               "omit the camera, or calibrate again",
                               {{"error", explained.error}, {"error_with_the_models_camera", other}},
                               "camera"});
}

}  // namespace

Result<RigSearch> search_rig(const OpenedMethod& method, const FieldCheck& check, const Explanation& explained,
                             const capture::EventImages& cycle, const capture::EventImages& sum) {
  RigSearch found;
  E2LF_ASSIGN_OR_RETURN(auto camera, worse_camera(method, check, explained, cycle));
  if (camera) {
    found.findings.push_back(std::move(*camera));
    return found;
  }
  E2LF_ASSIGN_OR_RETURN(auto change, better_change(check, explained, cycle, found.changes));
  auto places = diagnose::check_places(sum, check.camera().codes, check.camera().pixels, method.views);
  const bool is_of_places = places && !(change && change->is_clear) && (places->severity != Severity::kNote || !change);
  if (is_of_places) found.findings.push_back(std::move(*places));
  if (change && !is_of_places) found.findings.push_back(std::move(change->finding));
  return found;
}

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
Result<std::optional<PatternFit>> fit_of(const std::string& name, MethodChoice choice,
                                         const capture::EventImages& cycle, diagnose::Findings& findings) {
  E2LF_ASSIGN_OR_RETURN(OpenedMethod method, open_method(std::move(choice)));
  E2LF_ASSIGN_OR_RETURN(const auto check, FieldCheck::create(method));
  if (!check) return std::optional<PatternFit>();
  E2LF_ASSIGN_OR_RETURN(auto explained, check->judge_events(cycle));
  if (!explained) return std::optional<PatternFit>();
  if (name.empty()) findings.insert(findings.end(), method.findings.begin(), method.findings.end());
  return std::optional(PatternFit{name, std::move(method), std::move(*explained)});
}

/// Judges the patterns that are stated, or else all bundled ones.
Result<void> add_fits(const MethodChoice& choice, const capture::EventImages& cycle, RigReport& report) {
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
    auto fit = fit_of(name, std::move(with_patterns), cycle, report.findings);
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
  E2LF_RETURN_IF_ERROR(input.check_transitions());
  E2LF_ASSIGN_OR_RETURN(const FirstCycles cycles, read_cycles(input));
  if (on_read) on_read();
  RigReport report{.cycles = cycles.counts.cycles, .is_confirmed = cycles.is_confirmed};
  if (input.is_recording()) {
    report.findings = report.cycles == 0 ? diagnose::Findings{input.rig().no_cycle_finding(input.reader())}
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
  if (input.is_recording()) choice.schedule = &input.reader().schedule();
  E2LF_ASSIGN_OR_RETURN(choice.events, input.setup());
  E2LF_RETURN_IF_ERROR(add_fits(choice, cycles.first, report));
  const PatternFit* best = report.fits.empty() ? nullptr : &report.fits.front();
  add(diagnose::check_event_images(cycles.first), report.findings);
  if (best == nullptr) return report;
  // Wrong times explain every other order and orientation.
  if (cycles.is_confirmed) {
    const size_t summed = std::min(cycles.counts.cycles, FirstCycles::kMostSummed);
    if (auto other = diagnose::check_order(cycles.sum, summed, best->method.known_setup())) {
      add({*std::move(other)}, report.findings);
    }
    E2LF_ASSIGN_OR_RETURN(const auto check, FieldCheck::create(best->method));
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
