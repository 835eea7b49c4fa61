// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/field_check.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
using diagnose::middle_of;
using diagnose::Severity;
namespace {

// docs/experiments/findings.md states how often these thresholds are wrong.
constexpr double kGoodRatio = 1.15;
constexpr double kWrongRatio = 1.5;
constexpr double kLeastRatio = 0.7;
constexpr double kLeastContrast = 0.1;
constexpr double kLeastNoiseError = 0.05;  // in counts, because a camera without noise still rounds
constexpr size_t kMostSide = 512;          // px
constexpr uint64_t kSeed = 1;
constexpr char kSearch[] = "run `e2lf check`, which searches for another polarity, order, orientation and camera";

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

void add_ratio(Explanation& explained) {
  const double tenths = std::round(10 * explained.ratio) / 10;
  const Json figures = {{"ratio", explained.ratio}, {"contrast", explained.contrast}};
  if (explained.ratio > kWrongRatio) {
    explained.findings.push_back(
        {"events-unexplained", Severity::kError,
         cat("the light field differs from its events by ", tenths, " times the difference that noise causes"), kSearch,
         figures});
  } else if (explained.ratio < kLeastRatio) {
    explained.findings.push_back(
        {"noise-explained", Severity::kWarning,
         cat("the light field differs from its events by only ", std::round(100 * explained.ratio) / 100,
             " times the difference that noise causes, as one that shows noise or fog does"),
         kSearch, figures});
  }
  if (explained.contrast < kLeastContrast) {
    explained.findings.push_back({"contrast-absent", Severity::kWarning,
                                  cat("the light field has hardly any contrast (", std::round(100 * explained.contrast),
                                      " %), so that its events confirm nothing"),
                                  cat("record a scene with edges, or ", kSearch), figures});
  }
}

}  // namespace

recon::EventCheck in_window(recon::EventCheck check, double share_of_width) {
  if (!check.pixels) return check;
  for (auto* slopes : {&check.pixels->transmission_slope_x, &check.pixels->transmission_slope_y}) {
    for (float& slope : *slopes) slope *= static_cast<float>(share_of_width);
  }
  return check;
}

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
          {"findings", diagnose::to_json(findings)}};
}

Result<std::optional<FieldCheck>> FieldCheck::create(const OpenedMethod& method, size_t cycles) {
  if (!method.codes) return std::optional<FieldCheck>();
  FieldCheck check;
  const MethodUse once{.cycles = cycles};
  E2LF_ASSIGN_OR_RETURN(check.own_.method, method.ready(once));
  E2LF_ASSIGN_OR_RETURN(check.own_.check.model, sensor::event_model_from_name(method.codes->event_model));
  check.own_.check.codes = method.codes->codes;
  check.own_.check.constants = method.codes->constants;
  check.own_.check.cycles = cycles;
  const bool is_pixel = method.camera && method.camera->is_pixel();
  if (is_pixel) check.own_.check.pixels = method.camera;
  if (method.lit) {
    check.lit_ = {method_of(method.lit, once), check.own_.check};
    check.lit_->check.codes = *method.lit->model().codes;
  }
  // The error of a method that does not use the sensor profile does not depend on the polarity or the order of the
  // events. If the camera of the events is unknown, a network is judged by its own profile.
  check.is_judged_ = method.camera ? !is_pixel || method.takes_sums() : method.network != nullptr;
  return std::optional(std::move(check));
}

Result<recon::EventError> FieldCheck::compare(const lightfield::LightField& light_field,
                                              const capture::EventImages& events, bool is_of_lit) const {
  return recon::event_error(candidate(is_of_lit).check, light_field, 1.0F, events);
}

Result<std::optional<Explanation>> FieldCheck::judge(const lightfield::LightField& light_field,
                                                     const capture::EventImages& events, bool is_of_lit) const {
  if (!is_judged_) return std::optional<Explanation>();
  const Candidate& own = candidate(is_of_lit);
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
  add_ratio(explained);
  return std::optional(std::move(explained));
}

Result<std::optional<Explanation>> FieldCheck::judge_events(const capture::EventImages& events) const {
  const capture::EventImages given = middle_of(events, kMostSide, kMostSide);
  FieldCheck middle = *this;
  const double share_of_width = static_cast<double>(given.width) / static_cast<double>(events.width);
  middle.own_.check = in_window(own_.check, share_of_width);
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField light_field, own_.method(given, {}));
  return middle.judge(light_field, given, false);
}

}  // namespace e2lf::pipeline
