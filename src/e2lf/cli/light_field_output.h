// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// The brightness of what is written: "auto" (recon::auto_gain) or a positive number. Fails with kInvalidValue.
[[nodiscard]] Result<float> resolve_gain(const std::string& gain, const lightfield::LightField& light_field);

/// Writes a reconstructed light field into an existing folder: its views in `format` ("png", "png16": VV_UU.png; "npy":
/// lightfield.npy, not clamped), contact_sheet.png and epi.png.
[[nodiscard]] Result<void> write_reconstruction(const std::filesystem::path& folder,
                                                const lightfield::LightField& light_field, const std::string& format,
                                                const ProgressFn& progress);

}  // namespace e2lf::cli
