// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/video/video_model.h"

namespace e2lf::compare {

/// Returns the views that an aperture with one open cell shows one after another in two scans over 8x8: back and forth
/// along the rows and then, from the last view, back and forth along the columns. These are 127 view numbers, each
/// adjacent to the previous one.
[[nodiscard]] std::vector<size_t> scan_order();

struct ScanOptions {
  float tau = 0.30F;  ///< both mean thresholds of the v2e pixels
  float gain = 1.0F;  ///< scene brightness
  uint64_t seed = 0;
};

/// The second scan as frames.
struct ScanResult {
  lightfield::LightField light_field;  ///< tone-mapped frames without a known scale
  double events_per_pixel = 0;         ///< sum over both scans
  double measurement_ms = 0;           ///< sum over both scans
  double reconstruct_s = 0;            ///< time taken by the network
};

/// Implements CA+E2VID of the paper: v2e pixels record events while scan_order() is shown, with each view as bright as
/// in the light field, and the network makes a frame from the events of each change of view. The frame at the end of
/// each view of the second scan is the reconstruction of that view. Fails with kShape for other than 8x8 grey views,
/// and as the network does.
[[nodiscard]] Result<ScanResult> scan_to_light_field(const video::VideoModel& model,
                                                     const lightfield::LightField& scene, const ScanOptions& options,
                                                     const ProgressFn& progress = {});

}  // namespace e2lf::compare
