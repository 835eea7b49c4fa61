// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/voxel_grid.h"
#include "e2lf/engine/engine.h"
#include "e2lf/model/video/video_model.h"

namespace e2lf::recon {

/// Makes frames of the voxel grids of a recording, one after another: the network remembers those before.
class EventVideo {
 public:
  /// For a sensor of that size in pixels. Fails as model::validate() and engine::Engine::create() do.
  [[nodiscard]] static Result<EventVideo> create(model::VideoModel model, size_t height, size_t width,
                                                 const engine::EngineOptions& options = {});

  /// What the network makes of the next grid, [y, x], as it is: apply_tone() makes a picture of it. The grid is
  /// normalised where the network wants that, and padded with zeros on all sides (the odd pixel above and to the left)
  /// to the model's multiple; the frame is cut back. The grid has model().bins bins and the size of the sensor.
  [[nodiscard]] Result<std::vector<float>> next(capture::VoxelGrid grid);

  /// Forgets what came before.
  void reset() { state_ = engine::FrameState(); }

  [[nodiscard]] const model::VideoModel& model() const { return model_; }
  [[nodiscard]] const engine::Engine& engine() const { return engine_; }

 private:
  EventVideo(model::VideoModel model, engine::Engine engine, size_t height, size_t width);
  model::VideoModel model_;
  engine::Engine engine_;
  engine::FrameState state_;
  size_t height_, width_;                ///< of the sensor
  size_t padded_height_, padded_width_;  ///< of what the network sees
};

}  // namespace e2lf::recon
