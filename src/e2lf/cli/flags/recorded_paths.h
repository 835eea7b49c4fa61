// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::cli {

/// An input of an earlier run that is not found any more, and the flag that would name another one.
struct MissingInput {
  std::string flag, placed;  ///< what the flag holds while nobody names another one
  Error error;
};

/// Makes paths of a run's record mean what they meant in that run, from whatever folder it is made again: a relative
/// one is taken from the folder where the run was started ("folder" of the record), and where nothing of this name is
/// there any more, from the current one. Changes the options of `record` that are paths by what `app` declares or by
/// what the record lists as inputs, and those inputs. Returns the inputs that are in neither folder.
[[nodiscard]] std::vector<MissingInput> find_recorded_paths(Json& record, const CLI::App& app);

}  // namespace e2lf::cli
