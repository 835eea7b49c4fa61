// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/field_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
using diagnose::Finding;
using diagnose::middle_of;
using diagnose::OtherOrientation;
using diagnose::Severity;
namespace {

// docs/experiments/findings.md states how often these thresholds are wrong.
constexpr double kGoodRatio = 1.15;
constexpr double kWrongRatio = 1.5;
constexpr double kLeastRatio = 0.7;
constexpr double kLeastContrast = 0.1;
constexpr double kCameraRatio = 1.2;       // ratio of the error to that with the network's camera
constexpr double kLeastNoiseError = 0.05;  // in counts, because a camera without noise still rounds
constexpr double kChangedRatio = 0.97;     // ratio of the error of changed events to that of the given ones
constexpr double kClearRatio = 0.8;        // the same if the given events are explained as well as noise permits
constexpr double kLeastExplained = 0.95, kMostExplained = 1.005;  // range of `ratio` for correct events
constexpr size_t kMostSide = 512, kMostSideOfChanged = 192;       // px
constexpr uint64_t kSeed = 1;

/// Returns the same camera for a window in the middle of the image.
recon::EventCheck in_window(recon::EventCheck check, double share_of_width) {
  if (!check.pixels) return check;
  for (auto* slopes : {&check.pixels->transmission_slope_x, &check.pixels->transmission_slope_y}) {
    for (float& slope : *slopes) slope *= static_cast<float>(share_of_width);
  }
  return check;
}

/// Returns the error that the noise of the camera alone causes, for the sum of as many cycles as are compared.
Result<double> noise_error(const recon::EventCheck& check, const lightfield::LightField& light_field) {
  capture::EventImages sum;
  for (size_t cycle = 0; cycle < check.cycles; ++cycle) {
    const uint64_t seed = kSeed + cycle;
    const Result<capture::EventImages> events =
        check.pixels
            ? sensor::simulate_pixel_events(check.codes, light_field, *check.pixels, {.seed = seed, .map_seed = kSeed})
            : sensor::simulate_events(check.codes, light_field,
                                      {.model = check.model, .constants = check.constants, .seed = seed});
    if (!events) return events.error();
    if (cycle == 0) {
      sum = *events;
    } else {
      add_counts(*events, sum);
    }
  }
  E2LF_ASSIGN_OR_RETURN(const recon::EventError error, recon::event_error(check, light_field, 1.0F, sum));
  return error.least;
}

/// Returns the contrast of the middle view, averaged over blocks of 8x8 px so that noise does not count.
double contrast_of(const lightfield::LightField& light_field) {
  constexpr size_t kSide = 8;
  const lightfield::Shape& shape = light_field.shape();
  std::vector<double> blocks;
  for (size_t y = 0; y + kSide <= shape.height; y += kSide) {
    for (size_t x = 0; x + kSide <= shape.width; x += kSide) {
      double sum = 0;
      for (size_t i = 0; i < kSide * kSide; ++i) {
        sum += light_field.at(shape.views_y / 2, shape.views_x / 2, y + i / kSide, x + i % kSide);
      }
      blocks.push_back(std::max(sum, 0.0));
    }
  }
  if (blocks.size() < 4) return 1;
  std::ranges::sort(blocks);
  const double dark = blocks[blocks.size() / 20], bright = blocks[blocks.size() - 1 - blocks.size() / 20];
  return bright <= 0 ? 0 : (bright - dark) / (bright + dark);
}

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

capture::EventImages reordered(const capture::EventImages& events, const std::vector<size_t>& order) {
  capture::EventImages result(events.count, events.height, events.width);
  for (size_t k = 0; k < events.count; ++k) std::ranges::copy(events.image(order[k]), result.image(k).begin());
  return result;
}

/// A possible mistake of the rig, as the change of the events that undoes it.
struct Change {
  const char* code;
  std::string name, remedy;
  std::function<capture::EventImages(const capture::EventImages&)> apply;
};

Change inversion() {
  return {"polarity-better-inverted", "with inverted polarity", "give `invert-polarity`, or omit it if it was given",
          [](capture::EventImages events) {
            for (int16_t& count : events.values) count = capture::saturated(-count);
            return events;
          }};
}

std::vector<Change> other_orders(size_t transitions) {
  std::vector<size_t> order(transitions);
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<Change> changes;
  const auto add = [&](const std::vector<size_t>& changed) {
    std::vector<std::string> numbers;
    for (const size_t number : changed) numbers.push_back(std::to_string(number));
    changes.push_back({"order-better-changed", cat("with the event images in the order ", join(numbers)),
                       "check the order of the patterns in `codes` and on the display, and `first-pattern`",
                       [changed](const capture::EventImages& events) { return reordered(events, changed); }});
  };
  for (size_t shift = 1; shift < transitions; ++shift) {
    std::vector<size_t> rotated = order;
    std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(shift), rotated.end());
    add(rotated);
  }
  for (size_t i = 0; i + 1 < transitions && transitions > 2; ++i) {
    std::vector<size_t> swapped = order;
    std::swap(swapped[i], swapped[i + 1]);
    add(swapped);
  }
  if (transitions > 3) add({order.rbegin(), order.rend()});
  return changes;
}

Result<double> error_of(const recon::Method& method, const recon::EventCheck& check,
                        const capture::EventImages& events) {
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, method(events, {}));
  E2LF_ASSIGN_OR_RETURN(const recon::EventError error, recon::event_error(check, light_field, 1.0F, events));
  return error.least;
}

/// Returns the change that lets the method explain the events better than the given ones, if there is one. One correct
/// scene in twenty is explained slightly better in another order, so that a clear difference is required if the events
/// are explained as well as their noise allows.
Result<std::optional<Finding>> better_change(const recon::Method& method, const recon::EventCheck& check,
                                             const capture::EventImages& events, double ratio, Json& tried) {
  const size_t side = std::min({events.height, events.width, kMostSideOfChanged});
  const recon::EventCheck own = in_window(check, static_cast<double>(side) / static_cast<double>(events.width));
  const capture::EventImages given = middle_of(events, side, side);
  E2LF_ASSIGN_OR_RETURN(const double unchanged, error_of(method, own, given));
  std::vector<Change> changes = other_orders(events.count);
  changes.push_back(inversion());
  for (const OtherOrientation& other : diagnose::kOtherOrientations) {
    changes.push_back({"orientation-better-changed", other.name, other.remedy,
                       [&other](const capture::EventImages& images) { return oriented(images, other); }});
  }
  const Change* best = nullptr;
  double least = 0;
  for (const Change& change : changes) {
    if (stop_requested()) return std::optional<Finding>();
    E2LF_ASSIGN_OR_RETURN(const double error, error_of(method, own, change.apply(given)));
    tried[change.name] = error / unchanged;
    if (best != nullptr && error >= least) continue;
    best = &change;
    least = error;
  }
  const bool is_explained = ratio >= kLeastExplained && ratio <= kMostExplained;
  if (best == nullptr || least >= (is_explained ? kClearRatio : kChangedRatio) * unchanged) {
    return std::optional<Finding>();
  }
  const auto rounded = [](double value) { return std::round(1000 * value) / 1000; };
  return std::optional(
      Finding{best->code,
              Severity::kError,
              cat("the events are explained better ", best->name, ": the light field differs from them by ",
                  rounded(least), " instead of ", rounded(unchanged)),
              best->remedy,
              {{"error", least}, {"unchanged_error", unchanged}, {"change", best->name}}});
}

void add_ratio(Explanation& explained) {
  const double tenths = std::round(10 * explained.ratio) / 10;
  const Json figures = {{"ratio", explained.ratio}, {"contrast", explained.contrast}};
  if (explained.ratio > kWrongRatio) {
    explained.findings.push_back(
        {"events-unexplained", Severity::kError,
         cat("the light field differs from its events by ", tenths, " times the difference that noise causes"),
         "check the polarity of the events, the order of the patterns and the `camera`", figures});
  } else if (explained.ratio < kLeastRatio) {
    explained.findings.push_back(
        {"noise-explained", Severity::kWarning,
         cat("the light field differs from its events by only ", std::round(100 * explained.ratio) / 100,
             " times the difference that noise causes, as one that shows noise or fog does"),
         "check the polarity of the events, the order of the patterns and the `camera`", figures});
  }
  if (explained.contrast < kLeastContrast) {
    explained.findings.push_back({"contrast-absent", Severity::kWarning,
                                  cat("the light field has hardly any contrast (", std::round(100 * explained.contrast),
                                      " %), so that its events confirm nothing"),
                                  "record a scene with edges, or check the polarity and the order of the patterns",
                                  figures});
  }
}

}  // namespace

std::string Explanation::verdict(bool is_confirmed) const {
  if (diagnose::has_doubt(findings)) return "doubtful";
  if (!is_confirmed) return "unconfirmed";
  return ratio > kGoodRatio ? "usual" : "good";
}

Json Explanation::json(bool is_confirmed) const {
  return {{"verdict", verdict(is_confirmed)},
          {"error", error},
          {"noise_error", noise_error},
          {"ratio", ratio},
          {"contrast", contrast},
          {"changes", tried},
          {"findings", diagnose::to_json(findings)}};
}

Result<std::optional<FieldCheck>> FieldCheck::create(const OpenedMethod& method, const MethodUse& use) {
  if (!method.codes) return std::optional<FieldCheck>();
  FieldCheck check;
  MethodUse once = use;
  once.passes = 1;
  E2LF_ASSIGN_OR_RETURN(check.own_.method, method.ready(once));
  E2LF_ASSIGN_OR_RETURN(check.own_.check.model, sensor::event_model_from_name(method.codes->event_model));
  check.own_.check.codes = method.codes->codes;
  check.own_.check.constants = method.codes->constants;
  check.own_.check.cycles = use.cycles;
  const bool is_pixel = method.camera && method.camera->is_pixel();
  if (is_pixel) check.own_.check.pixels = method.camera;
  if (method.lit) {
    check.lit_ = {method_of(method.lit, once), check.own_.check};
    check.lit_->check.codes = *method.lit->model().codes;
  }
  if (method.models_camera) {
    const auto network =
        std::make_shared<const recon::Reconstructor>(method.network->with_camera(*method.models_camera));
    check.of_models_camera_ = {method_of(network, once), check.own_.check};
    check.of_models_camera_->check.pixels = method.models_camera;
  }
  // The error of a method that does not use the sensor profile does not depend on the polarity or the order of the
  // events. If the camera of the events is unknown, a network is judged by its own profile.
  if (method.camera ? !is_pixel || method.takes_sums() : method.network != nullptr) {
    check.is_judged_ = true;
  }
  return std::optional(std::move(check));
}

Result<recon::EventError> FieldCheck::compare(const lightfield::LightField& light_field,
                                              const capture::EventImages& events, bool is_of_lit) const {
  return recon::event_error(candidate(is_of_lit).check, light_field, 1.0F, events);
}

Result<std::optional<Explanation>> FieldCheck::judge(const lightfield::LightField& light_field,
                                                     const capture::Measurement& measurement, bool is_of_lit,
                                                     bool is_confirmed) const {
  if (!is_judged_) return std::optional<Explanation>();
  const Candidate& own = candidate(is_of_lit);
  const capture::EventImages& events = measurement.events;
  const capture::EventImages given = middle_of(events, kMostSide, kMostSide);
  const double share_of_width = static_cast<double>(given.width) / static_cast<double>(events.width);
  const recon::EventCheck check = in_window(own.check, share_of_width);
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField part,
                        lightfield::crop(light_field, {(events.height - given.height) / 2,
                                                       (events.width - given.width) / 2, given.height, given.width}));
  E2LF_ASSIGN_OR_RETURN(const recon::EventError error, recon::event_error(check, part, 1.0F, given));
  Explanation explained{.error = error.least, .contrast = contrast_of(part)};
  E2LF_ASSIGN_OR_RETURN(explained.noise_error, noise_error(check, part));
  explained.ratio = explained.error / std::max(explained.noise_error, kLeastNoiseError);
  if (of_models_camera_ && !is_of_lit) {
    E2LF_ASSIGN_OR_RETURN(const double other, error_of(of_models_camera_->method,
                                                       in_window(of_models_camera_->check, share_of_width), given));
    if (explained.error > kCameraRatio * other) {
      explained.findings.push_back({"camera-worse",
                                    Severity::kError,
                                    cat("the camera that was given explains the events much worse than the one for "
                                        "which the network was trained: "
                                        "the light field differs from them by ",
                                        explained.error, " instead of ", other),
                                    "omit `camera`, or calibrate again",
                                    {{"error", explained.error}, {"error_with_the_models_camera", other}}});
      return std::optional(std::move(explained));
    }
  }
  // Intensity images have no signs.
  if (is_confirmed && measurement.kind == capture::MeasurementKind::kEventImages && !stop_requested()) {
    E2LF_ASSIGN_OR_RETURN(auto change, better_change(own.method, own.check, events, explained.ratio, explained.tried));
    auto places = diagnose::check_places(given, check.codes, check.pixels);
    // The parallax is more sensitive to the patterns, and independent of the polarity and the order of event images.
    const bool is_clear =
        change && (change->code == "polarity-better-inverted" ||
                   change->figures["error"] < kClearRatio * change->figures["unchanged_error"].get<double>());
    const bool is_of_places = places && !is_clear && (places->severity != Severity::kNote || !change);
    if (is_of_places) explained.findings.push_back(std::move(*places));
    if (change && !is_of_places) explained.findings.push_back(std::move(*change));
  }
  if (!diagnose::has_doubt(explained.findings)) add_ratio(explained);
  return std::optional(std::move(explained));
}

Result<std::optional<Explanation>> FieldCheck::judge_events(const capture::EventImages& events) const {
  const capture::Measurement given(middle_of(events, kMostSide, kMostSide));
  FieldCheck middle = *this;
  const double share_of_width = static_cast<double>(given.events.width) / static_cast<double>(events.width);
  middle.own_.check = in_window(own_.check, share_of_width);
  if (middle.of_models_camera_) {
    middle.of_models_camera_->check = in_window(of_models_camera_->check, share_of_width);
  }
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, own_.method(given, {}));
  return middle.judge(light_field, given, false, true);
}

}  // namespace e2lf::pipeline
