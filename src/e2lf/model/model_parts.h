// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/files/safetensors.h"
#include "e2lf/model/model.h"

/// Internal parts of reading and writing model files, which models of frames (e2lf/video) share.
namespace e2lf::model {

inline constexpr size_t kFormatVersion = 1;

/// The key of the JSON in the metadata of a file, and the JSON itself. Fails with kFormat if there is none.
inline constexpr const char* kMetadataKey = "e2lf";
[[nodiscard]] Result<Json> header_of(const Safetensors& tensors, const std::string& file);

/// Fails with kUnsupported if the header has another version than kFormatVersion, or if it states that the model takes
/// a voxel grid (`is_video`) or one of light fields instead.
inline constexpr const char* kVoxelGrid = "voxel-grid";
[[nodiscard]] Result<void> check_kind(const Json& header, bool is_video, const std::string& location);

/// Checks that the weights are those of the network: all present, of the right size, and finite.
[[nodiscard]] Result<void> validate_weights(const Network& network, const Weights& weights,
                                            const std::string& location);

/// Converts between a model and the JSON of its file, which contains everything except the tensors.
[[nodiscard]] Json header_to_json(const Model& model);
[[nodiscard]] Result<Model> header_from_json(const Json& json, const std::string& location);

/// Extracts the weights of the network from `tensors`. Fails with kNotFound, kShape, kUnsupported (neither F32 nor
/// BF16) and kFormat (a tensor that no layer reads, which indicates another network than the one described). The
/// location is `file` and the tensor.
[[nodiscard]] Result<Weights> weights_from_tensors(const Network& network, const Safetensors& tensors,
                                                   const std::string& file);

}  // namespace e2lf::model
