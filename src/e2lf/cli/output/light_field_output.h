// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/field_sequence.h"

namespace e2lf::cli {

/// The brightness that --gain asks for; nothing for "auto". Fails with kInvalidValue.
[[nodiscard]] Result<std::optional<float>> parse_gain(const std::string& gain);
/// The same of --black: a number that is finite and at least 0.
[[nodiscard]] Result<std::optional<float>> parse_black(const std::string& black);

/// What --gain and --black say. Black is looked for where physical pixels leave it open and brightness is not to be
/// measured. Fails as parse_gain() and parse_black().
[[nodiscard]] Result<recon::Tone> tone_of(const std::string& gain, const std::string& black,
                                          const std::optional<capture::SensorProfile>& camera);

/// Writes a reconstructed light field into an existing folder: its views in `format` ("png", "png16": VV_UU.png; "npy":
/// lightfield.npy, not clamped), contact_sheet.png and epi.png. All pictures are upright, where the views come out as
/// `views` says, and so is `light_field` afterwards; lightfield.npy keeps their order, which is that of the patterns.
[[nodiscard]] Result<void> write_reconstruction(const std::filesystem::path& folder,
                                                lightfield::LightField& light_field, const std::string& format,
                                                const capture::Orientation& views, const ProgressFn& progress);

/// How the views in the files of write_reconstruction() still lie.
[[nodiscard]] capture::Orientation stored_views(const std::string& format, const capture::Orientation& views);

}  // namespace e2lf::cli
