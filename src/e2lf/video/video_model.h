// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "e2lf/base/result.h"
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

/// Converts between a tone and its name in model files: "none", "robust", "standard" or "exp-robust".
[[nodiscard]] const char* tone_name(FrameTone tone);
[[nodiscard]] Result<FrameTone> tone_from_name(const std::string& name);

inline constexpr size_t kMaxBins = 1024;  ///< largest number of bins of a model

/// A network that makes grey frames from the voxel grids (capture/measurement/measurement.h) of consecutive windows of a
/// recording. Its memory is carried from frame to frame. It is stored as a model file with "measurement": "voxel-grid".
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

/// Summarises such a model for `e2lf model info`, as JSON and as text: name, measurement, bins, treatment of voxels and
/// frames, figures of the network and provenance.
[[nodiscard]] Json summary_json(const VideoModel& model);
[[nodiscard]] std::string summary_text(const VideoModel& model);

}  // namespace e2lf::video
