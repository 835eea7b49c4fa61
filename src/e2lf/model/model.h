// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/options.h"
#include "e2lf/model/network.h"

namespace e2lf::model {

/// The kinds of input channel groups of a network. They are made from the event images E_1 ... E_(N-1), from the sensor
/// profile, or from intensity images.
enum class InputKind {
  kCounts,      ///< scale * E_k
  kCumulative,  ///< scale * C_k, C_k = E_1 + ... + E_k
  kLevel,       ///< scale * L_k, L_k = C_k + s_k / 2, where s_k is the sign of the last E that is not zero
  kIntensity,   ///< scale * min(J_k, 1), J_k = eps * (exp(tau * L_k) - 1) (Eq. 7); a coded intensity is at most 1
  kCamera,      ///< scale * the conditioning vector capture::conditioning_vector(), each number constant over the image
  kImages,      ///< scale * the coded intensity image of each of N patterns
  kImageSum,    ///< scale * the one intensity image that integrates all patterns
  kLensArray,   ///< scale * each of 64 views from a lens array, interpolated bilinearly between lens centres
  /// What is known whatever the patterns are, kMovedPlanes channels, of the pictures behind the patterns that were
  /// moved by the disparity to the viewpoints of the lit patterns of e2lf-n4 (geometry::kPlaces): the inputs of
  /// e2lf-n4-depth (kInputsOfMoved); the slots of the levels and of the intensities (geometry::Aperture) where the
  /// events were; disparity and logarithm of its scale, times 0.3; and, constant over the image, the aperture. Only
  /// composed models have it (composition.h).
  kMoved,
};

inline constexpr size_t kMovedPlanes = 55;

/// What the planes of InputKind::kMoved begin with, which are those of networks for four patterns.
inline constexpr InputKind kInputsOfMoved[] = {InputKind::kCounts, InputKind::kCumulative, InputKind::kLevel,
                                               InputKind::kIntensity, InputKind::kCamera};

/// Their names in files.
inline constexpr Choice<InputKind> kInputKinds[] = {
    {"counts", InputKind::kCounts},       {"cumulative", InputKind::kCumulative}, {"level", InputKind::kLevel},
    {"intensity", InputKind::kIntensity}, {"camera", InputKind::kCamera},         {"images", InputKind::kImages},
    {"image-sum", InputKind::kImageSum},  {"lens-array", InputKind::kLensArray},  {"moved", InputKind::kMoved},
};

struct InputGroup {
  InputKind kind = InputKind::kCounts;
  float scale = 1.0F;
  bool operator==(const InputGroup&) const = default;
};

/// Returns whether a group is made from the counts of event images.
[[nodiscard]] inline bool is_of_counts(const InputGroup& group) {
  return group.kind == InputKind::kCounts || group.kind == InputKind::kCumulative || group.kind == InputKind::kLevel ||
         group.kind == InputKind::kIntensity;
}

/// Returns the number of channels that a group of this kind, or all groups together, have for N patterns.
[[nodiscard]] size_t num_input_channels(InputKind kind, size_t num_patterns);
[[nodiscard]] size_t num_input_channels(const std::vector<InputGroup>& groups, size_t num_patterns);

/// Returns the kind of measurement from which these groups are made. Fails with kInvalidValue if no measurement
/// provides all of them.
[[nodiscard]] Result<capture::MeasurementKind> measurement_of(const std::vector<InputGroup>& groups);

/// What a network loses in arithmetic other than float32: the PSNR (of disparities for a network for depth) with
/// float32 minus that with the other, dB, on scenes that were simulated for this network. An absent value was not
/// measured.
struct PrecisionLoss {
  std::optional<double> bfloat16_db = {}, int16_db = {};
  bool operator==(const PrecisionLoss&) const = default;
};

/// Weights whose shape no layer states.
struct SharedWeights {
  std::vector<size_t> shape;
  std::vector<float> values;
};

struct OpenGuide;  // composition.h

/// The contents of a model file.
struct Model {
  std::string name;         ///< e.g. "e2lf-n4"
  size_t num_patterns = 0;  ///< N; the input has N - 1 event images, or what measurement() states
  size_t views_y = 8, views_x = 8;
  std::optional<capture::Codes> codes;          ///< absent if the patterns belong to a user's camera
  std::string event_model = "reference-aware";  ///< the event model of its training: "quantised" or "reference-aware"
  bool black_first = true;
  capture::SensorConstants constants;            ///< the constants of its training
  std::optional<capture::SensorProfile> camera;  ///< the default camera; if absent, `constants` are used
  std::vector<InputGroup> input;                 ///< in channel order
  Network network;                               ///< 64 output channels = views; view number = 8 * view_y + view_x
  Weights weights;                               ///< "<layer>.weight", "<layer>.bias"
  /// What geometry::for_patterns() makes the weights of other patterns of, by the names of weights; empty for networks
  /// that work for `codes` alone.
  std::map<std::string, SharedWeights> any_patterns = {};
  bool is_adapted = false;            ///< geometry::for_patterns() made it for `codes`; files do not state it
  PrecisionLoss precision_loss = {};  ///< precisions that were checked for these weights
  Json provenance = Json::object();   ///< free-form: data, samples seen, seed, command, results
  std::vector<std::filesystem::path> parts = {};  ///< files of the models that it was composed of; see composition.h
  /// The network for any patterns that the views follow as soon as geometry::for_patterns() adapts it; usually null.
  std::shared_ptr<const OpenGuide> open_guide = {};

  /// Returns the kind of measurement that the input needs. The model must be valid.
  [[nodiscard]] capture::MeasurementKind measurement() const { return measurement_of(input).value(); }
};

/// Returns true if the network is conditioned on the sensor profile and the number of cycles.
[[nodiscard]] bool is_conditioned_on_camera(const Model& model);

/// Returns true if geometry::for_patterns() can adapt the network to other patterns.
[[nodiscard]] inline bool is_for_any_patterns(const Model& model) {
  return !model.any_patterns.empty() || model.open_guide;
}

/// Returns true if the network was trained for any patterns, and not for those that it has.
[[nodiscard]] inline bool serves_any_patterns(const Model& model) {
  return is_for_any_patterns(model) || model.is_adapted;
}

/// Returns true for networks of views for any patterns, which read InputKind::kMoved.
[[nodiscard]] bool reads_moved_pictures(const Model& model);

/// Checks that all fields are consistent: channels, codes and weights (all present, of the right size, and finite).
/// `location` names the file in errors.
[[nodiscard]] Result<void> validate(const Model& model, const std::string& location);

/// Reads a model file (format version 1), a .safetensors file with weights in float32 or bfloat16, `aperture.codes` [N,
/// view_y, view_x] if the model has codes, weights "any.<name>" of a network for any patterns, and JSON under `e2lf` in
/// its metadata; or a small file that states of which two models it is composed (composition.h), which are beside it or
/// bundled. Fails on an unknown version, network type or key, a wrong shape, a missing part, truncation, and as
/// validate() does. The message names file and field.
[[nodiscard]] Result<Model> read_model(const std::filesystem::path& path);

/// Reads a model file in memory in the same way. `name` is the location in errors, and `folder` contains the parts of a
/// composed model; empty = they are bundled ones.
[[nodiscard]] Result<Model> decode_model(std::span<const uint8_t> bytes, const std::string& name,
                                         const std::filesystem::path& folder = {});

/// The storage of weights in a model file: exact, or in half the space with relative errors of at most 2^-8.
enum class WeightStorage { kFloat32, kBfloat16 };

/// Writes a model file. Fails as validate() does, before anything is written, and with kIo.
[[nodiscard]] Result<void> write_model(const std::filesystem::path& path, const Model& model,
                                       WeightStorage storage = WeightStorage::kFloat32);

/// Summarises a model for `e2lf model info --json`: name, patterns, views, event model, constants, input, figures of
/// the network, light efficiency of its codes (null if it has none) and provenance. The model must pass validate().
[[nodiscard]] Json summary_json(const Model& model);

/// Returns true if a file states that it is a model of frames (e2lf/video). Fails as read_model() does if it is not a
/// model.
[[nodiscard]] Result<bool> is_video_model(const std::filesystem::path& path);

/// Imports the released weights of the paper as a model. `folder` must contain RecNet.safetensors and
/// AcqNet.safetensors. Fails with kNotFound and kShape if they are not the released ones, and as read_safetensors does.
[[nodiscard]] Result<Model> import_release(const std::filesystem::path& folder);

/// The number of outputs of a depth network: the disparity of view (views_y / 2, views_x / 2) in px per view step, and
/// the logarithm of its scale. They are the parameters of a Laplace distribution.
inline constexpr size_t kDepthOutputs = 2;

/// Returns true if a network gives disparities instead of views: it has kDepthOutputs outputs.
[[nodiscard]] bool is_depth_network(const Model& model);

}  // namespace e2lf::model
