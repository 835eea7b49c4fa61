// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "e2lf/files/output.h"
#include "python/binding/calls.h"

namespace e2lf::python {

/// Writes a file that appears complete, by the rules of the verbs: an existing file is replaced only if `overwrite` is
/// set. `write` receives the path to write to and returns a Result. Runs without the GIL.
template <typename Write>
void write_output(const std::filesystem::path& path, bool overwrite, const Write& write) {
  without_gil([&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(path, {.overwrite = overwrite}));
    E2LF_RETURN_IF_ERROR(write(output.path()));
    return output.commit();
  });
}

}  // namespace e2lf::python
