// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/lens.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {

/// A disparity map with everything that its files contain.
struct DisparityResult {
  depth::DisparityMap map;
  lightfield::Image picture;  ///< of the view, in colour if available
  lightfield::Shape shape;
  std::string name;             ///< of its folder, if there are several
  Json about = Json::object();  ///< what the record says beside the figures of the map
};

/// Returns the next map, or nothing after the last one.
using DisparitySource = std::function<Result<std::optional<DisparityResult>>()>;

struct DisparityOutput {
  std::filesystem::path input, output;
  bool is_one = true;  ///< whether the folder itself gets the files of the one map
  float least_confidence = 0.1F;
  std::optional<depth::Lens> lens = {};  ///< without it, points are in units of the distance of disparity 0
};

/// Returns true if the name is that of a single file: .npy, .pfm, .png or .ply.
[[nodiscard]] bool is_disparity_file(const std::filesystem::path& output);

/// Writes the first map to a file, or all of them to a folder, with the record, and prints what was written. Fails as
/// the source, and with kNotFound if it has no map.
[[nodiscard]] Result<void> write_disparities(const DisparityOutput& output, const DisparitySource& source,
                                             RunRecord& record, const Verb& verb);

}  // namespace e2lf::cli
