// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/video/video_model.h"

namespace e2lf::video {

/// Returns the names of the published networks whose checkpoints can be read: "firenet" (Scheerlinck et al., WACV
/// 2020), "firenet+", "e2vid+" (Stoffregen et al., ECCV 2020), "e2vid" (Rebecq et al., TPAMI 2021), "ssl-e2vid"
/// (Paredes-Valles and de Croon, CVPR 2021), "hypere2vid" (Ercan et al., TIP 2024) and "et-net" (Weng et al., ICCV
/// 2021).
[[nodiscard]] std::vector<std::string> event_video_names();

/// Imports a published checkpoint as a model. `path` is its state dictionary as a .safetensors file with unchanged
/// tensor names. The layers follow from these names and shapes. Batch normalisation is folded into the preceding
/// convolutions, and if there are several output channels, only the first (the picture) is kept. Properties that no
/// tensor determines (normalisation of the voxels, padding, a final sigmoid, the tone of the frames) follow the EVREAL
/// protocol (Ercan et al., CVPRW 2023) for the network `as`. If it is empty, the network is determined from the tensor
/// names; if two networks share the names, it is "e2vid" if there is batch normalisation and "e2vid+" otherwise. Fails
/// with kUnsupported (unknown tensor names, or transposed convolutions), kNotFound, kShape, kFormat (a tensor that is
/// not used) and kInvalidValue (`as` is unknown or has other layers).
[[nodiscard]] Result<VideoModel> import_event_video(const std::filesystem::path& path, const std::string& as = "");

}  // namespace e2lf::video
