// SPDX-License-Identifier: MIT
#include "e2lf/depth/flipped_axis.h"

#include <algorithm>
#include <numeric>

#include "e2lf/depth/occlusion.h"
#include "e2lf/lightfield/crop.h"
#include "e2lf/lightfield/orient.h"

namespace e2lf::depth {
namespace {

constexpr size_t kWindowPx = 256;
/// Light fields in the correct order have a mean confidence above 0.45, unless they are noisy or have little texture.
constexpr double kLowConfidence = 0.45;
/// With a flipped axis, the views are much less consistent with a single depth than in the correct order.
constexpr float kMuchLessResidual = 0.8F;
constexpr double kMuchMoreConfidence = 1.2;

}  // namespace

double mean_confidence(const DisparityMap& map) {
  const auto& values = map.confidence.pixels;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Result<FlippedAxis> find_flipped_axis(const lightfield::LightField& light_field, const DisparityMap& map) {
  const lightfield::Shape& shape = light_field.shape();
  if (shape.views_y < 2 || shape.views_x < 2 || mean_confidence(map) > kLowConfidence) return FlippedAxis::kNone;
  const size_t height = std::min(shape.height, kWindowPx), width = std::min(shape.width, kWindowPx);
  E2LF_ASSIGN_OR_RETURN(
      lightfield::LightField window,
      lightfield::crop(light_field, {(shape.height - height) / 2, (shape.width - width) / 2, height, width}));
  E2LF_ASSIGN_OR_RETURN(const DisparityMap as_it_is, estimate_disparity(window));
  lightfield::orient(window, {.flip_x = true});
  E2LF_ASSIGN_OR_RETURN(const DisparityMap flipped, estimate_disparity(window));
  const bool fits_better = flipped.residual < kMuchLessResidual * as_it_is.residual &&
                           mean_confidence(flipped) > kMuchMoreConfidence * mean_confidence(as_it_is);
  if (!fits_better) return FlippedAxis::kNone;
  const OcclusionSign sign = occlusion_sign(window, flipped);
  if (sign.verdict == OcclusionSign::Verdict::kUndecided) return FlippedAxis::kEither;
  return sign.verdict == OcclusionSign::Verdict::kUpright ? FlippedAxis::kX : FlippedAxis::kY;
}

}  // namespace e2lf::depth
