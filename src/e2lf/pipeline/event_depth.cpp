// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/event_depth.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/model/model.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::pipeline {
namespace {

/// Returns the mean intensity of the coded pictures relative to a white scene. A threshold of sums over cycles is that
/// of one cycle divided by their number.
Result<lightfield::Image> mean_picture(const model::Model& model, const capture::EventImages& events, size_t cycles) {
  recon::InversionOptions options{.constants = model.camera->constants, .centred = cycles == 1};
  options.constants.tau /= static_cast<float>(cycles);
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities coded, recon::invert_events(events, options));
  float light = static_cast<float>(coded.count) / 2;
  if (model.codes) {
    const std::vector<float> shares = capture::light_efficiency(*model.codes);
    light = std::accumulate(shares.begin(), shares.end(), 0.0F);
  }
  lightfield::Image picture(coded.width, coded.height, 1);
  for (size_t n = 0; n < coded.count; ++n) {
    for (size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] += coded.image(n)[i] / light;
  }
  return picture;
}

/// Returns the map whose disparities have Laplace distributions with this location (px per view step) and logarithm of
/// the scale, [y, x] each. The expected error is the scale, from which the confidence follows: 0.5 at 0.07 px. The
/// range is that of the disparities.
depth::DisparityMap map_of_laplace(lightfield::Image location, const lightfield::Image& log_scale,
                                   const depth::ViewIndex& view) {
  constexpr float kHalfErrorPx = 0.07F, kMostLog = 20.0F;  // beyond this, squares overflow
  depth::DisparityMap map{.disparity = std::move(location), .confidence = log_scale, .view = view, .range = {}};
  for (float& value : map.confidence.pixels) {
    const float ratio = std::exp(std::min(value, kMostLog)) / kHalfErrorPx;
    value = 1 / (1 + ratio * ratio);
  }
  const auto [least, most] = std::minmax_element(map.disparity.pixels.begin(), map.disparity.pixels.end());
  map.range = {*least, *most};
  return map;
}

}  // namespace

Result<EventDepth> depth_of_outputs(const model::Model& model, const lightfield::LightField& outputs,
                                    const capture::EventImages& events, size_t cycles,
                                    const capture::Orientation& views) {
  if (views.flip_x != views.flip_y) {
    return fail(ErrorCode::kUnsupported, "",
                "the views are flipped along one axis, where depth is not found from events; show the patterns flipped "
                "in the same way, or estimate the depth of a reconstructed light field");
  }
  lightfield::Image location = lightfield::view_image(outputs, 0, 0);
  if (!views.is_upright()) {
    for (float& value : location.pixels) value = -value;
  }
  // Light fields are written upright, where the view of the network has another number if the grid was turned.
  depth::ViewIndex view{model.views_y / 2, model.views_x / 2};
  if (!views.is_upright()) view = {model.views_y - 1 - view.y, model.views_x - 1 - view.x};
  depth::DisparityMap map = map_of_laplace(std::move(location), lightfield::view_image(outputs, 0, 1), view);
  E2LF_ASSIGN_OR_RETURN(lightfield::Image picture, mean_picture(model, events, cycles));
  return EventDepth{std::move(map), std::move(picture)};
}

Result<EventDepth> depth_of_events(const OpenedMethod& method, const capture::Measurement& measurement, size_t cycles,
                                   const capture::Orientation& views, const ProgressFn& progress) {
  E2LF_REQUIRE(method.network && model::is_depth_network(method.network->model()), "a depth network");
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField outputs,
                        method.network->reconstruct(measurement, progress, 1, cycles));
  return depth_of_outputs(method.network->model(), outputs, measurement.events, cycles, views);
}

std::optional<diagnose::Finding> range_finding(const model::Model& model, const depth::DisparityMap& map) {
  constexpr double kMuch = 0.02;
  const auto sweep = std::ranges::find(model.network.layers, geometry::GeometryOp::kPlaneSweep, &model::Layer::op);
  if (sweep == model.network.layers.end()) return std::nullopt;
  const std::vector<double>& compared = sweep->attributes.at("disparities");
  if (compared.size() < 2) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(compared);
  const double step = (most - least) / static_cast<double>(compared.size() - 1);
  // Views that are turned by 180 degrees change the sign of the disparities.
  const double limit = std::min(most, -least) - step;
  const auto at_end = std::ranges::count_if(map.disparity.pixels, [&](float d) { return std::abs(d) > limit; });
  const double share = static_cast<double>(at_end) / static_cast<double>(map.disparity.pixels.size());
  if (share < kMuch) return std::nullopt;
  return diagnose::Finding{
      "disparity-range",
      diagnose::Severity::kWarning,
      cat("the disparities of ", formatted("%.0f %%", 100 * share), " of the pixels are at the end of the range of ",
          model.name, formatted(" (%.1f to %.1f px)", least, most), ", where the true ones may be larger"),
      "focus the lens nearer to these parts, or use smaller distances between the patterns",
      {{"share", share}}};
}

std::optional<diagnose::Finding> confidence_finding(const depth::DisparityMap& map) {
  constexpr double kFew = 0.1;
  const auto known = std::ranges::count_if(map.confidence.pixels, [](float c) { return c >= depth::kLeastConfidence; });
  const double share = static_cast<double>(known) / static_cast<double>(map.confidence.pixels.size());
  if (share >= kFew) return std::nullopt;
  return diagnose::Finding{
      "disparity-uncertain",
      diagnose::Severity::kWarning,
      cat("only ", formatted("%.0f %%", 100 * share), " of the pixels have a disparity with a confidence of at least ",
          formatted("%.2f", depth::kLeastConfidence)),
      "use more light, and run `e2lf check`, which searches for another polarity, order, orientation and camera",
      {{"share", share}}};
}

}  // namespace e2lf::pipeline
