// SPDX-License-Identifier: MIT
#include "e2lf/depth/lens.h"

#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"

namespace e2lf::depth {

std::array<double, 2> Lens::ray(double x_px, double y_px) const {
  constexpr int kIterations = 20;  // the distortion is inverted by fixed-point iteration, as OpenCV does
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double distorted_x = (x_px - centre_x_px) / focal_x_px, distorted_y = (y_px - centre_y_px) / focal_y_px;
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
  std::array<double, 2> focal{}, centre{};
  OptionReader reader(json, path.string() + ": $");
  reader.read("width", lens.width)
      .read("height", lens.height)
      .read("focal_px", focal)
      .read("centre_px", centre)
      .read("distortion", lens.distortion)
      .read("baseline_m", lens.baseline_m)
      .read("focus_m", lens.focus_m);
  E2LF_RETURN_IF_ERROR(reader.finish());
  lens.focal_x_px = focal[0];
  lens.focal_y_px = focal[1];
  lens.centre_x_px = centre[0];
  lens.centre_y_px = centre[1];
  const std::pair<const char*, double> lengths[] = {{"width", static_cast<double>(lens.width)},
                                                    {"height", static_cast<double>(lens.height)},
                                                    {"focal_px", lens.focal_x_px},
                                                    {"focal_px", lens.focal_y_px},
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
