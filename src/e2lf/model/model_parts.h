// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/files/safetensors.h"
#include "e2lf/model/model.h"

/// The parts a model file is read and written with; not for other modules.
namespace e2lf::model {

inline constexpr size_t kFormatVersion = 1;

/// The JSON of a model file: everything but the tensors, and back.
[[nodiscard]] Json header_to_json(const Model& model);
[[nodiscard]] Result<Model> header_from_json(const Json& json, const std::string& location);

/// The network's weights out of `tensors`. Fails with kNotFound, kShape and kUnsupported (not F32); the location is
/// `file` and the tensor.
[[nodiscard]] Result<Weights> weights_from_tensors(const Network& network, const Safetensors& tensors,
                                                   const std::string& file);

}  // namespace e2lf::model
