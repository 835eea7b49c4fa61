// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::cli {

/// An input of an earlier run that no longer exists, and the flag that can name another one.
struct MissingInput {
  std::string flag, placed;  ///< the flag, and its value unless the user sets another
  Error error;
};

/// Resolves the paths of a run's record, so that the run can be repeated from any folder. A relative path is resolved
/// against the folder in which the run was started ("folder" of the record), or against the current folder if it does
/// not exist there. Changes the options in `record` that `app` declares as paths or that the record lists as inputs,
/// and the list of inputs. Returns the inputs that exist in neither folder.
[[nodiscard]] std::vector<MissingInput> find_recorded_paths(Json& record, const CLI::App& app);

}  // namespace e2lf::cli
