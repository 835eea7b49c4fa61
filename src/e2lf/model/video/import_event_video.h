// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/model/video/video_model.h"

namespace e2lf::model {

/// The published networks whose checkpoints are read: "firenet" (Scheerlinck et al., WACV 2020), "firenet+", "e2vid+"
/// (Stoffregen et al., ECCV 2020), "e2vid" (Rebecq et al., TPAMI 2021), "ssl-e2vid" (Paredes-Valles and de Croon, CVPR
/// 2021), "hypere2vid" (Ercan et al., TIP 2024), "et-net" (Weng et al., ICCV 2021).
[[nodiscard]] std::vector<std::string> event_video_names();

/// A published checkpoint as a model: `path` is its state dictionary as a .safetensors file, with the names of its
/// tensors as they are. The layers are told by these names and shapes; batch normalisation is folded into the
/// convolutions before it; of several output channels the first is kept, which is the picture.
/// What no tensor tells (normalisation of the voxels, padding, a final sigmoid, the tone of the frames) is what the
/// EVREAL protocol (Ercan et al., CVPRW 2023) says of the network `as`; empty: that of the names, and of two with the
/// same names "e2vid" where there is batch normalisation, else "e2vid+".
/// Fails with kUnsupported (names of no network that is known, transposed convolutions), kNotFound, kShape, kFormat (a
/// tensor that nothing reads), kInvalidValue (`as` is unknown or has other layers).
[[nodiscard]] Result<VideoModel> import_event_video(const std::filesystem::path& path, const std::string& as = "");

}  // namespace e2lf::model
