// SPDX-License-Identifier: MIT
#include "e2lf/recon/event_judgement.h"

#include <algorithm>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/crop.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::recon {
namespace {

// docs/troubleshooting.md states how often these thresholds are wrong.
constexpr double kGoodRatio = 1.15;
constexpr double kWrongRatio = 1.5;
constexpr double kRivalRatio = 1.2;        // ratio of the error to that of the rival
constexpr double kLeastNoiseError = 0.05;  // in counts, because a camera without noise still rounds
constexpr double kChangedRatio = 0.97;     // ratio of the error of changed events to that of the given ones
constexpr double kClearRatio = 0.8;        // the same if the given events are explained as well as noise permits
constexpr double kLeastExplained = 0.95, kMostExplained = 1.005;  // range of `ratio` for correct events
constexpr size_t kMostSide = 512, kMostSideOfChanged = 192;       // px
constexpr uint64_t kSeed = 1;

lightfield::CropRegion middle_of(const capture::EventImages& events, size_t most_side) {
  const size_t height = std::min(events.height, most_side), width = std::min(events.width, most_side);
  return {(events.height - height) / 2, (events.width - width) / 2, height, width};
}

capture::EventImages crop(const capture::EventImages& events, const lightfield::CropRegion& region) {
  capture::EventImages part(events.count, region.height, region.width);
  for (size_t k = 0; k < events.count; ++k) {
    for (size_t y = 0; y < region.height; ++y) {
      const auto row = events.image(k).subspan((region.y + y) * events.width + region.x, region.width);
      std::copy(row.begin(), row.end(), part.image(k).begin() + static_cast<std::ptrdiff_t>(y * region.width));
    }
  }
  return part;
}

/// Returns the same camera for a window in the middle of the image.
EventCheck in_window(EventCheck check, double share_of_width) {
  if (!check.pixels) return check;
  for (auto* slopes : {&check.pixels->transmission_slope_x, &check.pixels->transmission_slope_y}) {
    for (float& slope : *slopes) slope *= static_cast<float>(share_of_width);
  }
  return check;
}

Result<double> noise_error(const EventCheck& check, const lightfield::LightField& light_field) {
  const Result<capture::EventImages> events =
      check.pixels ? sensor::simulate_pixel_events(check.codes, light_field, *check.pixels, {.seed = kSeed})
                   : sensor::simulate_events(check.codes, light_field,
                                             {.model = check.model, .constants = check.constants, .seed = kSeed});
  if (!events) return events.error();
  E2LF_ASSIGN_OR_RETURN(const EventError error, event_error(check, light_field, 1.0F, *events));
  return error.least;
}

/// A possible mistake in the events: inverted signs, or another order of the transitions.
struct Change {
  std::string name;
  bool inverts = false;
  std::vector<size_t> order;  ///< of the images
};

std::vector<Change> possible_changes(size_t transitions) {
  std::vector<size_t> order(transitions);
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<Change> changes = {{"with inverted polarity", true, order}};
  const auto add = [&](const std::vector<size_t>& changed) {
    std::string name = "in the order ";
    for (size_t i = 0; i < changed.size(); ++i) name += cat(i == 0 ? "" : ", ", changed[i]);
    if (changed != order) changes.push_back({std::move(name), false, changed});
  };
  for (size_t shift = 1; shift < transitions; ++shift) {
    std::vector<size_t> rotated = order;
    std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(shift), rotated.end());
    add(rotated);
  }
  for (size_t i = 0; i + 1 < transitions; ++i) {
    std::vector<size_t> swapped = order;
    std::swap(swapped[i], swapped[i + 1]);
    add(swapped);
  }
  if (transitions > 3) add({order.rbegin(), order.rend()});
  return changes;
}

capture::EventImages changed(const capture::EventImages& events, const Change& change) {
  capture::EventImages result(events.count, events.height, events.width);
  for (size_t k = 0; k < events.count; ++k) {
    const auto image = events.image(change.order[k]);
    std::transform(image.begin(), image.end(), result.image(k).begin(),
                   [&](int count) { return capture::saturated(change.inverts ? -count : count); });
  }
  return result;
}

Result<double> error_of(const EventCheck& check, const Method& method, const capture::EventImages& events) {
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, method(capture::Measurement(events), {}));
  E2LF_ASSIGN_OR_RETURN(const EventError error, event_error(check, light_field, 1.0F, events));
  return error.least;
}

/// Determines whether changed events are explained better than the given ones.
Result<void> compare_with_changed(const EventCheck& check, const Method& method, const capture::EventImages& events,
                                  EventJudgement& judgement) {
  const lightfield::CropRegion region = middle_of(events, kMostSideOfChanged);
  const EventCheck own = in_window(check, static_cast<double>(region.width) / static_cast<double>(events.width));
  const capture::EventImages given = crop(events, region);
  E2LF_ASSIGN_OR_RETURN(judgement.unchanged_error, error_of(own, method, given));
  for (const Change& change : possible_changes(events.count)) {
    E2LF_ASSIGN_OR_RETURN(const double error, error_of(own, method, changed(given, change)));
    if (!judgement.change.empty() && error >= judgement.changed_error) continue;
    judgement.changed_error = error;
    judgement.change = change.name;
  }
  return {};
}

Verdict verdict_of(const EventJudgement& judgement) {
  if (judgement.rival_error && judgement.error > kRivalRatio * *judgement.rival_error) return Verdict::kRivalBetter;
  // One correct scene in twenty is explained slightly better in another order, so that a clear difference is required
  // if the events are explained as well as their noise allows.
  const bool is_explained = judgement.ratio >= kLeastExplained && judgement.ratio <= kMostExplained;
  const double needed = is_explained ? kClearRatio : kChangedRatio;
  if (!judgement.change.empty() && judgement.changed_error < needed * judgement.unchanged_error) {
    return Verdict::kChangedBetter;
  }
  if (judgement.ratio > kWrongRatio) return Verdict::kWrong;
  return judgement.ratio > kGoodRatio ? Verdict::kUsual : Verdict::kGood;
}

}  // namespace

Result<EventJudgement> judge(const EventCheck& check, const lightfield::LightField& light_field,
                             const capture::EventImages& events, const std::optional<Rival>& rival,
                             const Method& method) {
  const lightfield::CropRegion region = middle_of(events, kMostSide);
  const double share_of_width = static_cast<double>(region.width) / static_cast<double>(events.width);
  const EventCheck own = in_window(check, share_of_width);
  const capture::EventImages given = crop(events, region);
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField part, lightfield::crop(light_field, region));
  EventJudgement judgement;
  E2LF_ASSIGN_OR_RETURN(const EventError error, event_error(own, part, 1.0F, given));
  judgement.error = error.least;
  E2LF_ASSIGN_OR_RETURN(judgement.noise_error, noise_error(own, part));
  judgement.ratio = judgement.error / std::max(judgement.noise_error, kLeastNoiseError);
  if (rival) {
    E2LF_ASSIGN_OR_RETURN(const lightfield::LightField other, rival->method(capture::Measurement(given), {}));
    E2LF_ASSIGN_OR_RETURN(const EventError others,
                          event_error(in_window(rival->check, share_of_width), other, 1.0F, given));
    judgement.rival_error = others.least;
  }
  if (method) E2LF_RETURN_IF_ERROR(compare_with_changed(check, method, events, judgement));
  judgement.verdict = verdict_of(judgement);
  return judgement;
}

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kUsual:
      return "usual";
    case Verdict::kRivalBetter:
      return "rival-better";
    case Verdict::kChangedBetter:
      return "changed-better";
    case Verdict::kWrong:
      return "wrong";
  }
  return "";
}

}  // namespace e2lf::recon
