// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/video/checkpoint_importer.h"

namespace e2lf::video {

/// Returns true if a checkpoint has the transformers of ET-Net between its encoders and decoders.
[[nodiscard]] bool has_transformers(const CheckpointImporter& importer);

/// Imports these transformers. `cells` are the layers of the encoders, from fine to coarse. The output of each is
/// reduced to the coarsest resolution and gets a position code. Then self-attention (three layers in the published
/// network) and cross-attention to the next coarser encoder (two layers) are applied. The result is the mean of the
/// outputs of both stages. The number of heads, which no tensor determines, is 8. Fails as the importer does, and with
/// kShape and kUnsupported if the tensors belong to another kind of transformer.
[[nodiscard]] Result<std::string> import_transformers(CheckpointImporter& importer,
                                                      const std::vector<std::string>& cells);

}  // namespace e2lf::video
