// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {

/// Writes a reconstructed light field to an existing folder: its views in `format` ("png" and "png16": VV_UU.png;
/// "npy": lightfield.npy, not clamped), contact_sheet.png and epi.png. `views` is the orientation of the views; all
/// images are written upright, and `light_field` is upright afterwards. Only lightfield.npy keeps the order of the
/// views, which is that of the patterns.
[[nodiscard]] Result<void> write_reconstruction(const std::filesystem::path& folder,
                                                lightfield::LightField& light_field, const std::string& format,
                                                const capture::Orientation& views, const ProgressFn& progress);

/// Returns the name of the folder of a cycle: cycle_00000, cycle_00001, ...
[[nodiscard]] std::string cycle_name(size_t cycle);

/// The results of one run in a folder: a single one in the folder itself, or each in a folder of its own, which appears
/// complete when it is done, so that it can be used while later ones are computed. The folder itself appears with the
/// first result, so that an input without results replaces nothing, or, if the run is strict, at the end, when it is
/// known that no data were left out.
class ResultParts {
 public:
  ResultParts(ResultFolder folder, bool is_one, bool is_strict)
      : folder_(std::move(folder)), is_one_(is_one), is_strict_(is_strict) {}

  /// Returns the folder to which the next result is written.
  [[nodiscard]] Result<std::filesystem::path> begin(const std::string& name);
  /// Completes this result; `about` is the record of its folder. Fails as the functions of ResultFolder do.
  [[nodiscard]] Result<void> commit(const std::string& name, Json about, const program::RunRecord& run);
  /// Completes the run.
  [[nodiscard]] Result<void> finish(const program::RunRecord& run);

 private:
  ResultFolder folder_;
  bool is_one_, is_strict_, is_in_place_ = false;
};

}  // namespace e2lf::cli
