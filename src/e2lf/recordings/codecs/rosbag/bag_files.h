// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "e2lf/recordings/codecs/rosbag/bag.h"

namespace e2lf::recordings::rosbag {

/// Opens the files of a bag's folder one after the other, as one bag: those of metadata.yaml in its order, or where
/// there is none all of them by name. Files compressed as a whole are unpacked. Fails with kNotFound and as they do.
[[nodiscard]] Result<std::unique_ptr<Bag>> open_bag_folder(const std::filesystem::path& folder);

}  // namespace e2lf::recordings::rosbag
