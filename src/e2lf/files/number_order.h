// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace e2lf {

/// Returns true if the name of a file comes before another one where numbers in names count as numbers: bag_2 before
/// bag_10, and -2 before -1 before 0. A minus that follows a letter or a digit separates two parts of a name.
[[nodiscard]] bool is_before_in_number_order(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace e2lf
