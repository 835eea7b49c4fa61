// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/voxel_grid.h"
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

}  // namespace e2lf::video
