// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/model/checkpoint_importer.h"

namespace e2lf::model {

/// Whether the decoder under a key filters each pixel by filters of its own, as HyperE2VID's first one does.
[[nodiscard]] bool is_dynamic_decoder(const CheckpointImporter& importer, const std::string& key);

/// Such a decoder behind its upsampling. Voxel grid and last picture, at a quarter of the resolution, give coefficients
/// (two 3x3 convolutions with batch normalisation and tanh) that weigh fixed bases; the sums are each pixel's filters.
/// A 1x1 convolution mixes what they make of all channels. `input` is at a quarter of the resolution, too.
/// Fails as the importer does, and with kShape where the numbers of bases, coefficients and filters do not fit.
[[nodiscard]] Result<std::string> import_dynamic_decoder(CheckpointImporter& importer, const std::string& name,
                                                         const std::string& key, const std::string& input);

}  // namespace e2lf::model
