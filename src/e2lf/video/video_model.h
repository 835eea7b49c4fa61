// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/engine/engine.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model.h"

namespace e2lf::video {

/// The mapping applied to a frame after the network, before it is clamped to [0, 1]. Quantiles are those of the frame,
/// with linear interpolation between its sorted values.
enum class FrameTone {
  kNone,       ///< nothing
  kRobust,     ///< (I - q1) / (q99 - q1), where q1 and q99 are the 1 % and 99 % quantiles
  kStandard,   ///< the same with the smallest and the largest value
  kExpRobust,  ///< exp(I), then kRobust
};

/// The names of the tones in model files and options.
inline constexpr Choice<FrameTone> kFrameTones[] = {{"none", FrameTone::kNone},
                                                    {"robust", FrameTone::kRobust},
                                                    {"standard", FrameTone::kStandard},
                                                    {"exp-robust", FrameTone::kExpRobust}};

inline constexpr size_t kMaxBins = 1024;  ///< largest number of bins of a model

/// A network that makes grey frames from the voxel grids (capture/measurement/measurement.h) of consecutive windows of
/// a recording. Its memory is carried from frame to frame. It is stored as a model file with "measurement":
/// "voxel-grid".
struct VideoModel {
  std::string name;                ///< e.g. "firenet"
  size_t bins = 5;                 ///< bins of the voxel grid = input channels of the network
  bool normalises_voxels = false;  ///< each grid, to mean 0 and standard deviation 1 of its non-zero voxels
  size_t pad_multiple = 1;         ///< images are padded with zeros to multiples of this many pixels
  FrameTone tone = FrameTone::kNone;
  model::Network network;  ///< one output channel at the resolution of the input
  model::Weights weights;
  Json provenance = Json::object();
};

/// Checks that all fields are consistent. `location` names the file in errors.
[[nodiscard]] Result<void> validate(const VideoModel& model, const std::string& location);

/// Read, decode and write the file of such a model. They fail as read_model() and write_model() do, and with
/// kUnsupported on a model of light fields.
[[nodiscard]] Result<VideoModel> read_video_model(const std::filesystem::path& path);
[[nodiscard]] Result<VideoModel> decode_video_model(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] Result<void> write_video_model(const std::filesystem::path& path, const VideoModel& model);

/// Returns the JSON of the file, which contains everything except the weights.
[[nodiscard]] Json video_header_to_json(const VideoModel& model);

/// Summarises such a model for `e2lf model info`: name, measurement, bins, treatment of voxels and frames, figures of
/// the network and provenance.
[[nodiscard]] Json summary_json(const VideoModel& model);

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

/// Normalises the non-zero voxels to mean 0 and standard deviation 1, v <- (v - mean) / max(deviation, 1e-6), with the
/// mean and deviation of these voxels; the others remain zero.
void normalise_nonzero(std::span<float> voxels);

}  // namespace e2lf::video
