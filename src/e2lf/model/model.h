// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/camera.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/files/options.h"
#include "e2lf/model/network.h"

namespace e2lf::model {

/// One group of network input channels: N - 1 made from the event images E_k, what is known of the camera, or intensity
/// images.
enum class InputKind {
  kCounts,      ///< scale * E_k
  kCumulative,  ///< scale * C_k, C_k = E_1 + ... + E_k
  kIntensity,   ///< scale * min(J_k, 1), J_k = eps * (exp(tau * C_k + m) - 1) (Eq. 7), m = half a threshold with the
                ///< sign of the last change; a coded intensity is at most 1
  kCamera,      ///< scale * capture::camera_traits(), each the same over the whole image
  kImages,      ///< scale * the coded intensity image of each of N patterns
  kImageSum,    ///< scale * the one intensity image of all patterns
  kLensArray,   ///< scale * each of 64 views as a lens array gives it, between the centres of lenses bilinear
};

struct InputGroup {
  InputKind kind = InputKind::kCounts;
  float scale = 1.0F;
  bool operator==(const InputGroup&) const = default;
};

/// How many channels a group of this kind, or all groups, make for N patterns.
[[nodiscard]] size_t num_input_channels(InputKind kind, size_t num_patterns);
[[nodiscard]] size_t num_input_channels(const std::vector<InputGroup>& groups, size_t num_patterns);

/// What must be measured to make these groups. Fails with kInvalidValue where no measurement has all of them.
[[nodiscard]] Result<capture::MeasurementKind> measurement_of(const std::vector<InputGroup>& groups);

using Weights = std::map<std::string, std::vector<float>>;

/// Everything a model file holds.
struct Model {
  std::string name;         ///< e.g. "e2lf-n4"
  size_t num_patterns = 0;  ///< N; reconstruction takes N - 1 event images, or what measurement() says
  size_t views_y = 8, views_x = 8;
  std::optional<capture::Codes> codes;          ///< absent when the patterns belong to somebody's camera
  std::string event_model = "reference-aware";  ///< what it was trained for: "quantised" or "reference-aware"
  bool black_first = true;
  capture::SensorConstants constants;     ///< what it was trained for
  std::optional<capture::Camera> camera;  ///< the one it is used with where no other is named; absent: `constants`
  std::vector<InputGroup> input;          ///< in channel order
  Network network;                        ///< 64 output channels = views, view number = 8 * view_y + view_x
  Weights weights;                        ///< "<layer>.weight", "<layer>.bias"
  Json provenance = Json::object();       ///< data, samples seen, seed, command, figures reached: free form

  /// What its input needs; the model must be valid.
  [[nodiscard]] capture::MeasurementKind measurement() const { return measurement_of(input).value(); }
};

/// Whether the network is told the constants of the camera and the number of cycles.
[[nodiscard]] bool is_told_the_camera(const Model& model);

/// The words of model files: "counts", "cumulative", "intensity", "camera", "images", "image-sum", "lens-array".
[[nodiscard]] const char* input_kind_name(InputKind kind);

/// Success when every field fits every other: channels, codes, weights (each present, its size right, all finite).
/// `location` (a file) goes into errors.
[[nodiscard]] Result<void> validate(const Model& model, const std::string& location);

/// Reads a model file (format version 1): one .safetensors with weights in float32 or bfloat16, `aperture.codes` [N,
/// view_y, view_x] where the model has codes, and JSON under `e2lf` in its metadata. Fails with a message that names
/// file and field on an unknown version, network type or key, a wrong shape, truncation, and as validate() does.
[[nodiscard]] Result<Model> read_model(const std::filesystem::path& path);

/// The same of a model file in memory; `name` goes into errors.
[[nodiscard]] Result<Model> decode_model(std::span<const uint8_t> bytes, const std::string& name);

/// How a model file stores its weights: exactly, or in half the room with relative errors of at most 2^-8.
enum class WeightStorage { kFloat32, kBfloat16 };

/// Writes a model file. Fails as validate() does, before anything is written, and with kIo.
[[nodiscard]] Result<void> write_model(const std::filesystem::path& path, const Model& model,
                                       WeightStorage storage = WeightStorage::kFloat32);

/// Whether a file is one of a video_model.h by what it says of itself. Fails as read_model() does on what is no model.
[[nodiscard]] Result<bool> is_video_model(const std::filesystem::path& path);

/// The paper's released weights as a model: `folder` holds RecNet.safetensors and AcqNet.safetensors. Fails with
/// kNotFound and kShape where they are not the released ones, and as read_safetensors does.
[[nodiscard]] Result<Model> import_release(const std::filesystem::path& folder);

}  // namespace e2lf::model
