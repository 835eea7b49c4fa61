// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/files/safetensors.h"
#include "e2lf/model/model.h"

/// The parts a model file is read and written with; not for other modules.
namespace e2lf::model {

inline constexpr size_t kFormatVersion = 1;
inline constexpr size_t kMaxBins = 1024;  ///< of a model of frames

/// The key of the JSON in a file's metadata, and the JSON there. Fails with kFormat where there is none.
inline constexpr const char* kMetadataKey = "e2lf";
[[nodiscard]] Result<Json> header_of(const Safetensors& tensors, const std::string& file);

/// Fails with kUnsupported where the header is of another version than kFormatVersion, and where it says that the model
/// takes another measurement than `expected`: kVoxelGrid, or "" for those that light fields are made of.
inline constexpr const char* kVoxelGrid = "voxel-grid";
[[nodiscard]] Result<void> check_kind(const Json& header, const std::string& expected, const std::string& location);

/// Success when the weights are those of the network, each present, its size right, all finite.
[[nodiscard]] Result<void> validate_weights(const Network& network, const Weights& weights,
                                            const std::string& location);

/// The JSON of a model file: everything but the tensors, and back.
[[nodiscard]] Json header_to_json(const Model& model);
[[nodiscard]] Result<Model> header_from_json(const Json& json, const std::string& location);

/// The network's weights out of `tensors`. Fails with kNotFound, kShape and kUnsupported (not F32); the location is
/// `file` and the tensor.
[[nodiscard]] Result<Weights> weights_from_tensors(const Network& network, const Safetensors& tensors,
                                                   const std::string& file);

}  // namespace e2lf::model
