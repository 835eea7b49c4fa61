// SPDX-License-Identifier: MIT
#include "e2lf/depth/lens.h"

#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"

namespace e2lf::depth {

std::array<double, 2> Lens::ray(double x_px, double y_px) const {
  constexpr int kIterations = 20;  // the distortion is inverted by fixed-point iteration, as OpenCV does
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double distorted_x = (x_px - centre_px[0]) / focal_px[0], distorted_y = (y_px - centre_px[1]) / focal_px[1];
  double x = distorted_x, y = distorted_y;
  for (int i = 0; i < kIterations; ++i) {
    const double r2 = x * x + y * y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double next_x = (distorted_x - 2 * p1 * x * y - p2 * (r2 + 2 * x * x)) / radial;
    y = (distorted_y - p1 * (r2 + 2 * y * y) - 2 * p2 * x * y) / radial;
    x = next_x;
  }
  return {x, y};
}

Result<Lens> read_lens(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
  Lens lens;
  OptionReader reader(json, path.string() + ": $");
  E2LF_VISIT(lens, reader, width, height, focal_px, centre_px, distortion, baseline_m, focus_m);
  E2LF_RETURN_IF_ERROR(reader.finish());
  const std::pair<const char*, double> lengths[] = {{"width", static_cast<double>(lens.width)},
                                                    {"height", static_cast<double>(lens.height)},
                                                    {"focal_px", lens.focal_px[0]},
                                                    {"focal_px", lens.focal_px[1]},
                                                    {"baseline_m", lens.baseline_m},
                                                    {"focus_m", lens.focus_m}};
  for (const auto& [name, value] : lengths) {
    if (value > 0) continue;
    return fail(ErrorCode::kInvalidValue, reader.child_location(name),
                "the lens needs a positive length; calibrate it again");
  }
  return lens;
}

}  // namespace e2lf::depth
