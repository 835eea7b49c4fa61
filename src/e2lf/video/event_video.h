// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/engine/engine.h"
#include "e2lf/video/video_model.h"

namespace e2lf::video {

/// Makes frames from consecutive voxel grids of a recording. The network remembers the previous frames.
class EventVideo {
 public:
  /// Prepares the network for a sensor of this size in pixels. Fails as validate() and engine::Engine::create()
  /// do.
  [[nodiscard]] static Result<EventVideo> create(VideoModel model, size_t height, size_t width,
                                                 const engine::EngineOptions& options = {});

  /// Returns the unprocessed output of the network for the next grid, [y, x]; apply_tone() turns it into a picture. The
  /// grid is normalised if the model requires it, and padded with zeros on all sides (with the odd pixel above and to
  /// the left) to the model's multiple; the frame is cropped accordingly. The grid must have model().bins bins and the
  /// size of the sensor.
  [[nodiscard]] Result<std::vector<float>> next(capture::VoxelGrid grid);

  /// Resets the memory of previous frames.
  void reset() { state_ = engine::FrameState(); }

  [[nodiscard]] const VideoModel& model() const { return model_; }
  [[nodiscard]] const engine::Engine& engine() const { return engine_; }

 private:
  EventVideo(VideoModel model, engine::Engine engine, size_t height, size_t width);
  VideoModel model_;
  engine::Engine engine_;
  engine::FrameState state_;
  size_t height_, width_;                ///< size of the sensor
  size_t padded_height_, padded_width_;  ///< size of the network's input
};

/// Returns the quantile `share` (0 to 1) of the values, with linear interpolation between the sorted values at share (n
/// - 1), like numpy's percentile(). There must be at least one value and no NaN. The values are reordered.
[[nodiscard]] float quantile(std::span<float> values, double share);

/// Maps a frame to its range (see FrameTone) and clamps it to [0, 1]. A constant frame becomes 0 if the tone
/// uses quantiles.
void apply_frame_tone(FrameTone tone, std::span<float> frame);

}  // namespace e2lf::video
