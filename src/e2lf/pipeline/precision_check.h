// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"

namespace e2lf::pipeline {

/// Measures what a network loses on `scenes` in each arithmetic that this CPU supports; the others are
/// absent. The camera that the model was trained for is simulated. The loss is that of the mean squared error over all
/// scenes. Fails with kInvalidValue if the model has no codes, and as simulate_cycle() and recon::Reconstructor do.
[[nodiscard]] Result<model::PrecisionLoss> measure_precision_loss(const model::Model& model,
                                                                  std::span<const lightfield::LightField> scenes);

}  // namespace e2lf::pipeline
