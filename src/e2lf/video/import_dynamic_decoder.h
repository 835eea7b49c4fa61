// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/video/checkpoint_importer.h"

namespace e2lf::video {

/// Returns true if the decoder under a key applies filters specific to each pixel, as the first one of HyperE2VID does.
[[nodiscard]] bool is_dynamic_decoder(const CheckpointImporter& importer, const std::string& key);

/// Imports such a decoder, which follows its upsampling. The voxel grid and the previous picture, at a quarter of the
/// resolution, are mapped to coefficients (two 3x3 convolutions with batch normalisation and tanh) that weight fixed
/// bases. The sums are the filters of each pixel. A 1x1 convolution mixes the filtered channels. `input` is at a
/// quarter of the resolution, too. Fails as the importer does, and with kShape if the numbers of bases, coefficients
/// and filters do not fit.
[[nodiscard]] Result<std::string> import_dynamic_decoder(CheckpointImporter& importer, const std::string& name,
                                                         const std::string& key, const std::string& input);

}  // namespace e2lf::video
