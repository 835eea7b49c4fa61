// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "e2lf/recordings/codecs/rosbag/bag.h"

namespace e2lf::recordings::rosbag {

/// Opens the files of a bag's folder as one bag: those that metadata.yaml lists in its order, or, without it, all of
/// them sorted by name. Files that are compressed as a whole are decompressed. Fails with kNotFound, and as opening the
/// files does.
[[nodiscard]] Result<BagPtr> open_bag_folder(const std::filesystem::path& folder);

}  // namespace e2lf::recordings::rosbag
