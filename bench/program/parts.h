// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"

/// Functions that the benchmarks of networks share, and scenes that move before the camera.
namespace e2lf::bench {

struct Timing {
  double median = 0.0, min = 0.0, max = 0.0;
};

/// Returns the statistics of at least one measured time.
[[nodiscard]] Timing timing_of(std::vector<double> seconds);
[[nodiscard]] Json to_json(const Timing& timing);

/// Returns random weights that preserve the magnitude of values from layer to layer.
[[nodiscard]] model::Weights random_weights(const model::Network& network);

/// Returns a function of the module with a peer (e2lf_torch_peer.so, e2lf_onednn_peer.so) beside the program. If there
/// is none, returns null, and `absent` states the reason.
[[nodiscard]] void* find_in_peer(const char* module, const char* function, std::string& absent);

/// The largest motion within two cycles that scenes have room for, px.
constexpr size_t kMostMotionPx = 16;

/// Returns the middle rows of a scene, and its columns after it moved to the left by `motion_px`, which is at most
/// `most_px`. The result has at most size x size pixels. Fails with kShape if the scene is narrower than most_px + 17
/// px.
[[nodiscard]] Result<lightfield::LightField> in_view(const lightfield::LightField& scene, size_t size, size_t motion_px,
                                                     size_t most_px = kMostMotionPx);

/// Returns the largest PSNR of a light field against these scenes, dB. It is scaled by its least-squares factor for
/// each, so that a network that was trained for another camera does not lose by brightness alone. Fails with kShape.
[[nodiscard]] Result<double> best_psnr_db(const lightfield::LightField& field,
                                          const std::vector<lightfield::LightField>& scenes);

}  // namespace e2lf::bench
