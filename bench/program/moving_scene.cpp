// SPDX-License-Identifier: MIT
#include "bench/program/moving_scene.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/lightfield/crop.h"

namespace e2lf::bench {

using lightfield::LightField;

Result<LightField> in_view(const LightField& scene, size_t size, size_t motion_px) {
  constexpr size_t kMargin = kMostMotionPx + 1;
  const lightfield::Shape& shape = scene.shape();
  if (shape.width < kMargin + 16) {
    return Error{ErrorCode::kShape, cat("the views are narrower than ", kMargin + 16, " px; use larger ones"), ""};
  }
  const size_t height = std::min(size, shape.height);
  const size_t width = std::min(size, shape.width - kMargin);
  const size_t x = (shape.width - kMargin - width) / 2 + motion_px;
  return lightfield::crop(scene, {(shape.height - height) / 2, x, height, width});
}

Result<double> best_psnr_db(const LightField& field, const std::vector<LightField>& scenes) {
  double best = 0;
  for (const LightField& scene : scenes) {
    LightField fitted = field;
    const float gain = eval::best_gain(scene, field);
    for (float& value : fitted.data()) value *= gain;
    E2LF_ASSIGN_OR_RETURN(const auto metrics, eval::compare(scene, fitted));
    best = std::max(best, metrics.mean.psnr_db);
  }
  return best;
}

}  // namespace e2lf::bench
