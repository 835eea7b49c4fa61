// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Writes a reconstructed light field to an existing folder: its views in `format` ("png" and "png16": VV_UU.png;
/// "npy": lightfield.npy, not clamped), contact_sheet.png and epi.png. `views` is the orientation of the views; all
/// images are written upright, and `light_field` is upright afterwards. Only lightfield.npy keeps the order of the
/// views, which is that of the patterns.
[[nodiscard]] Result<void> write_reconstruction(const std::filesystem::path& folder,
                                                lightfield::LightField& light_field, const std::string& format,
                                                const capture::Orientation& views, const ProgressFn& progress);

}  // namespace e2lf::cli
