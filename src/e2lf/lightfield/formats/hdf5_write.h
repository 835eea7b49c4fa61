// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::lightfield {

/// Writes one float32 data set with these extents as an HDF5 file that appears either whole or not at all. Fails with
/// kIo, and with kInternal if HDF5 fails.
[[nodiscard]] Result<void> write_hdf5(const std::filesystem::path& path, const std::string& name,
                                      const std::vector<size_t>& extents, std::span<const float> values);

}  // namespace e2lf::lightfield
