// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/video/video_model.h"

namespace e2lf::compare {

/// The views that an aperture with one open cell shows one after another, twice over 8x8: to and fro along the rows,
/// then, from the last of these, to and fro along the columns. 127 numbers of views, each beside the one before.
[[nodiscard]] std::vector<size_t> scan_order();

struct ScanOptions {
  float tau = 0.30F;        ///< both mean thresholds of v2e's pixels
  float gain = 1.0F;        ///< scene brightness
  int64_t view_us = 10000;  ///< each view is shown so long
  int64_t frame_us = 1000;  ///< from frame to frame of v2e
  uint64_t seed = 0;
};

/// The second scan as frames.
struct ScanResult {
  lightfield::LightField light_field;  ///< of tones, at no known scale
  double events_per_pixel = 0;         ///< of both scans
  double measurement_ms = 0;           ///< of both scans
  double reconstruct_s = 0;            ///< what the network took
};

/// The paper's CA+E2VID: events of v2e's pixels while scan_order() is shown, each view as bright as it is in the light
/// field, then a frame of the network for the events of each change of view; what the network shows at the end of each
/// view of the second scan is that view. Fails with kShape for other than 8x8 grey views, and as the network does.
[[nodiscard]] Result<ScanResult> scan_to_light_field(const model::VideoModel& model,
                                                     const lightfield::LightField& scene, const ScanOptions& options,
                                                     const ProgressFn& progress = {});

}  // namespace e2lf::compare
