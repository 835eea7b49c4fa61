// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/model/checkpoint_importer.h"

namespace e2lf::model {

/// Whether a checkpoint has ET-Net's transformers between its encoders and decoders.
[[nodiscard]] bool has_transformers(const CheckpointImporter& importer);

/// These transformers. `cells` are the layers of the encoders, fine to coarse. What each gave is brought to the
/// coarsest resolution, with a code of the position; there pixels look at one another (three layers in the published
/// network), then at those of the next coarser encoder, too (two layers). The result is the mean of all that came out
/// of either. The number of heads, which no tensor tells, is 8. Fails as the importer does, and with kShape and
/// kUnsupported where the tensors are of another kind of transformer.
[[nodiscard]] Result<std::string> import_transformers(CheckpointImporter& importer,
                                                      const std::vector<std::string>& cells);

}  // namespace e2lf::model
